// SPDX-License-Identifier: MIT
// Fields of a record that are members of a measurement.
#pragma once

#include "harness/fields/field.h"
#include "harness/sampling/measurement.h"

namespace tandem::record_parts {

/// What the checking replay found, in `work`.
const Fields<Measurement>& found_counts();
/// How much work it took, as sums over its frames.
const Fields<FrameCounts>& effort_counts();

} // namespace tandem::record_parts
