// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/answers.h"
#include "algorithms/answer/growable_buffer.h"
#include "algorithms/answer/status.h"
#include "algorithms/narrow_phase/decision_stage.h"
#include "algorithms/expected_groups.h"

#include <memory>
#include <optional>

namespace tandem {

/// Decides which candidate pairs in a buffer meet and generates their contacts. Knows bodies only.
class ContactStage {
public:
    /// `at_once`: a launch takes pairs from one end to the other, one for each work-item, as the paper's
    /// release does. `apart`: a kernel each for certificates, for the tests of pairs of which they say
    /// nothing, and for the contacts of those that meet, so that work-items which run together all have work;
    /// a GPU with less than a pair for each of its work-items, as far as expect() tells, still does it at
    /// once.
    enum class Launches { at_once, apart };

    ContactStage(const Bodies& bodies, const ContactSettings& settings, LaunchShape shape, Launches launches);

    /// About how many pairs the next launches will find; nothing is known before the first call. No answer
    /// depends on it.
    void expect(std::uint64_t pairs) { expected_ = pairs; }
    /// Enqueues contact generation for pairs `first`..`end` - 1 of the answer's, as far as the status has
    /// counted so many; contacts follow those that the status counts already. Throws OutOfMemory.
    void launch(const AnswerBuffers& answer, std::uint64_t first, std::uint64_t end, const Status& status);

private:
    void reserve(std::uint64_t pairs);
    void find_meeting(const AnswerBuffers& answer, std::uint32_t first, std::uint32_t end,
                      const Status& status);
    void generate(const Kernel& kernel, LaunchShape shape, const AnswerBuffers& answer, std::uint32_t first,
                  std::uint32_t end, const Status& status);
    /// Whether verdicts are wanted of those pairs only that certificates leave open.
    bool decides_open() const { return decision_ && decision_->takes_certificates(); }
    const Buffer& verdicts() const { return decision_ ? decision_->verdicts() : nothing_; }

    const Bodies& bodies_;
    LaunchShape shape_, few_shape_;        ///< of three launches, of one
    ExpectedGroups groups_;                ///< of one launch
    Kernel certify_, separate_, generate_; ///< none for Launches::at_once
    Kernel at_once_;                       ///< none where it is never the better one
    std::optional<std::uint64_t> expected_;
    GrowableBuffer waiting_; ///< lists of waiting.clh: a column each, LIST_OPEN, LIST_MEETING
    Buffer nothing_;         ///< for a kernel that does not look at it
    std::unique_ptr<DecisionStage> decision_; ///< none for decision=fp32, which certify and separate do
};

} // namespace tandem
