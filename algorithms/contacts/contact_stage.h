// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/contacts/decision_stage.h"

#include <memory>

namespace tandem {

/// Decides which candidate pairs in a buffer meet and generates their contacts, into a buffer of its own.
class ContactStage {
public:
    ContactStage(const DeviceScene& scene, const ContactSettings& settings, std::uint64_t capacity,
                 std::uint32_t groups);

    /// Enqueues contact generation for pairs `first`.. of `found`, whose count stands in `status`.
    void launch(const Buffer& found, std::uint64_t first, std::uint64_t pair_capacity, const Buffer& status);
    /// Enqueues the digest of `count` contacts.
    void launch_digest(const Buffer& found, const Buffer& status);
    /// Makes room for `count` contacts; what was there is lost.
    void reserve(std::uint64_t count);

    std::uint64_t capacity() const { return capacity_; }
    const Buffer& ids() const { return ids_; }       ///< 2 words: pair, feature
    const Buffer& values() const { return values_; } ///< 8 reals: point, normal, depth, padding

private:
    const DeviceScene& scene_;
    std::uint32_t groups_;
    std::uint64_t capacity_ = 0;
    Buffer ids_, values_;
    Kernel generate_, digest_;
    Buffer no_verdicts_;
    std::unique_ptr<DecisionStage> decision_; ///< none for decision=fp32, which generate_contacts does itself
};

} // namespace tandem
