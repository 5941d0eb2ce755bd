// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/answers.h"
#include "algorithms/answer/growable_buffer.h"
#include "algorithms/answer/status.h"
#include "algorithms/narrow_phase/certify.cl.h"
#include "algorithms/narrow_phase/contacts.cl.h"
#include "algorithms/narrow_phase/decision_stage.h"
#include "algorithms/kernels/expected_groups.h"
#include "algorithms/narrow_phase/separate.cl.h"

#include <memory>
#include <optional>

namespace tandem {

/// Decides which candidate pairs in a buffer meet and generates their contacts. It depends only on bodies.
class ContactStage {
public:
    /// `at_once`: one launch processes each pair completely, one per work-item, as the paper's release does.
    /// `apart`: separate kernels for certificates, for tests of the pairs that these leave open, and for
    /// contacts of those that meet. Work-items that run together thus all have work. A GPU that expects less
    /// than one pair per work-item (see expect()) still uses one launch.
    enum class Launches { at_once, apart };

    ContactStage(const Bodies& bodies, const ContactSettings& settings, LaunchShape shape, Launches launches);

    /// Sets the expected number of pairs of the next launches; unknown before the first call. No answer
    /// depends on it.
    void expect(std::uint64_t pairs) { expected_ = pairs; }
    /// Enqueues contact generation for rows `first`..`end` - 1 of `pairs`, up to the count in the status.
    /// Contacts are appended to those that the status already counts. Throws OutOfMemory.
    void launch(const Buffer& pairs, const ContactRows& contacts, std::uint64_t first, std::uint64_t end,
                const Status& status);

    /// Reserves what launches of at most `pairs` pairs need. Throws OutOfMemory.
    void reserve(std::uint64_t pairs);

private:
    void reserve_lists(std::uint64_t pairs);
    LaunchShape apart_shape();
    /// Rows first..end - 1 of the candidate pairs, and the counts of their frame.
    struct Range {
        const Buffer& pairs;
        std::uint32_t first, end;
        const Status& status;
    };

    void find_meeting(const Range& range, LaunchShape shape);
    void generate(const KernelOf<kernels::contacts::GenerateContacts>& kernel, LaunchShape shape,
                  const Range& range, const ContactRows& contacts);
    /// Whether only the pairs that certificates leave open need verdicts.
    bool decides_open() const { return decision_ && decision_->uses_certificates(); }
    const Buffer& verdicts() const { return decision_ ? decision_->verdicts() : nothing_; }

    const Buffer& list(std::size_t number) const;

    const Bodies& bodies_;
    bool has_near_;                 ///< whether the rule wants pairs apart, too
    bool has_polygons_;             ///< whether no pair waits for separating axes
    float margin_;                  ///< its setting, rounded up
    LaunchShape shape_, few_shape_; ///< for three launches, for one
    ExpectedGroups groups_;         ///< for one launch on a GPU, and all on a processor
    // The first three are null for Launches::at_once.
    KernelOf<kernels::certify::CertifyPairs> certify_;
    KernelOf<kernels::separate::SeparatePairs> separate_;
    KernelOf<kernels::contacts::GenerateContacts> generate_;
    KernelOf<kernels::contacts::GenerateContacts> at_once_; ///< null where it is never the better choice
    std::optional<std::uint64_t> expected_;
    GrowableBuffer waiting_;                  ///< lists of pair_lists.clh, one column each
    Buffer nothing_;                          ///< for kernels that do not read the argument
    std::unique_ptr<DecisionStage> decision_; ///< null unless has_verdicts()
};

} // namespace tandem
