// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/growable_buffer.h"
#include "algorithms/traversal.h"

namespace tandem {

/// The partners of each body in a list of body pairs, for walks that do not go by body pairs: where each list
/// starts, one word per body and one for the end, then the lists, ascending. A pair is in both lists.
std::vector<std::uint32_t> partner_lists(std::span<const BodyPair> pairs, std::uint32_t bodies);

/// The same table on a device.
class PartnerLists {
public:
    /// Without lists, one unused word. `device` must outlive this.
    explicit PartnerLists(Device& device) : device_(device), table_(device, "partners of bodies", 4, 1) {}

    /// Enqueues the upload of the table. Throws OutOfMemory.
    void upload(std::span<const BodyPair> pairs, std::uint32_t bodies);

    const Buffer& table() const { return table_.buffer(); }

private:
    Device& device_;
    GrowableBuffer table_;
};

} // namespace tandem
