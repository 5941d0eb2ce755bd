// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "harness/verify/oracle/superset.h"
#include "scenes/contact.h"
#include "scenes/scene.h"

#include <functional>

namespace tandem::oracle {

/// A search for pairs of tetrahedra whose boxes overlap.
struct NearSearch {
    const Scene& scene;
    const std::vector<Boxes>& boxes; ///< by body
    SelfPairs self = SelfPairs::off;
    std::uint64_t fixed_bytes = 0; ///< allocated for the truth, whatever the number of pairs
    std::uint64_t memory = 0;      ///< limit of bytes, at least fixed_bytes
};

/// Calls visit(pairs) for all pairs of tetrahedra whose boxes overlap, in blocks: of bodies that may meet,
/// and with setting self those of one body that share no vertex. Then calls report with the fraction of pairs
/// and the number of pairs visited so far, unless it is empty. Throws InputError before the first call when
/// the pairs may take more than the memory.
void for_near_blocks(const NearSearch& search,
                     const std::function<void(double fraction, std::uint64_t visited)>& report,
                     const std::function<void(std::span<const Pair>)>& visit);

/// Throws InputError when the fixed bytes alone exceed the memory.
void check_memory(const Scene& scene, std::uint64_t fixed_bytes, std::uint64_t memory);

} // namespace tandem::oracle
