// SPDX-License-Identifier: MIT
#pragma once

#include "harness/oracle/decision.h"
#include "scenes/contact.h"

#include <span>
#include <vector>

namespace tandem::oracle {

/// Minima, then maxima.
using Box = std::array<double, 6>;

bool boxes_meet(const Box& p, const Box& q);

/// Boxes of a body's tetrahedra, and of all of them. Those with a coordinate that is not finite are empty
/// boxes and listed; those that are skipped are empty boxes.
struct Boxes {
    std::vector<Box> tetrahedra;
    Box whole{};
    std::vector<std::uint32_t> invalid;

    Boxes() = default;
    /// `skipped`: ascending.
    explicit Boxes(std::span<const TetraCorners> tetrahedra, std::span<const std::uint32_t> skipped = {});
};

/// Adds every pair of valid tetrahedra of two bodies whose closed boxes meet: a superset of those that meet,
/// since boxes are minima and maxima of the very coordinates the decision takes and nothing is rounded. Sorts
/// by lower bounds along x.
void add_near_pairs(const Boxes& a, const Boxes& b, std::uint32_t body_a, std::uint32_t body_b,
                    std::vector<Pair>& pairs);

} // namespace tandem::oracle
