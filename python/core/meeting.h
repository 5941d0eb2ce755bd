// SPDX-License-Identifier: MIT
#pragma once

#include "harness/verify/oracle/world.h"
#include "scenes/contact.h"

#include <span>
#include <vector>

namespace tandem::python {

/// Those of the pairs whose closed tetrahedra have a common point, in the same order. The decision is exact
/// for the corners of `world`, which are those of a device: moved and rounded. Runs on all cores.
std::vector<Pair> meeting_of(const oracle::World& world, std::span<const Pair> pairs);

} // namespace tandem::python
