// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/queued.clh"
#include "backends/device.h"

#include <array>
#include <cstdint>
#include <memory>

namespace tandem {

/// Where a frame leaves its answer that the host does not wait for (Session::enqueue): memory of the
/// session's device. Its commands, and those of later frames of the session, write it in the order of their
/// queue. The memory, and all other that the commands use, lives as long as this or a copy, also while a
/// session that grows its buffers replaces them; scene and device must live as long, too.
struct QueuedFrame {
    /// Rows of four 32-bit words: body a, tetrahedron a, body b, tetrahedron b, with the scene's numbers.
    /// Empty with output=count and output=digest.
    Buffer pairs;
    Buffer contact_ids; ///< rows of two words: row of `pairs`, feature; empty without contacts
    /// Rows of eight numbers, of 4 or 8 bytes by setting precision: point relative to `origin`, normal,
    /// depth, and one that is not used.
    Buffer contact_values;
    /// Six numbers of 64 bits, little end first: QUEUED_* bits (0: the answer is complete), candidate pairs,
    /// contacts, body pairs, and the sums of the digest with output=digest. They count further than the
    /// capacities; rows beyond these are not written.
    Buffer counts;
    std::uint64_t pair_capacity = 0, contact_capacity = 0; ///< in rows
    std::array<double, 3> origin{};                        ///< as FrameResult::origin
    std::shared_ptr<const void> memory;                    ///< all that the commands use
};

} // namespace tandem
