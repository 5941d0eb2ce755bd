// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/contacts/contact_settings.h"
#include "algorithms/kdop/device_scene.h"

namespace tandem {

/// Decides with certainty which candidate pairs in a buffer meet: settings decision=recheck, fp64 and exact.
/// STATUS_UNSURE counts the pairs that the filter, STATUS_UNCERTAIN those that double could not decide.
class DecisionStage {
public:
    DecisionStage(const DeviceScene& scene, DecisionPrecision decision, std::uint32_t groups);

    /// Enqueues verdicts for pairs `first`.. of `found`, whose count stands in `status`. With decision=exact
    /// it waits for the counts and, where there are any, for the pairs that double is unsure of.
    void launch(const Buffer& found, std::uint64_t first, std::uint64_t pair_capacity, const Buffer& status);

    const Buffer& verdicts() const { return verdicts_; } ///< a byte a pair, VERDICT_* of candidates.clh

private:
    void reserve(std::uint64_t pairs);
    void settle(const Buffer& found, const Buffer& status);

    const DeviceScene& scene_;
    DecisionPrecision decision_;
    std::uint32_t groups_;
    std::uint64_t room_ = 0;
    std::uint64_t settled_ = 0; ///< of the frame's uncertain pairs
    Buffer verdicts_, unsure_, uncertain_;
    Buffer corners_, answers_; ///< of the pairs the host decides; they live until their commands are done
    Kernel filter_, recheck_, gather_, settle_;
};

} // namespace tandem
