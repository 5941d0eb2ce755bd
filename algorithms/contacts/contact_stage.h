// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/answers.h"
#include "algorithms/answer/status.h"
#include "algorithms/contacts/decision_stage.h"

#include <memory>

namespace tandem {

/// Decides which candidate pairs in a buffer meet and generates their contacts. Knows bodies only.
class ContactStage {
public:
    ContactStage(const Bodies& bodies, const ContactSettings& settings, LaunchShape shape);

    /// Enqueues contact generation for pairs `first`..`end` - 1 of the answer's, as far as the status has
    /// counted so many; contacts follow those that the status counts already. Throws OutOfMemory.
    void launch(const AnswerBuffers& answer, std::uint64_t first, std::uint64_t end, const Status& status);

private:
    const Bodies& bodies_;
    LaunchShape shape_;
    Kernel generate_;
    Buffer no_verdicts_;
    std::unique_ptr<DecisionStage> decision_; ///< none for decision=fp32, which generate_contacts does itself
};

} // namespace tandem
