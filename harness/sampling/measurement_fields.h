// SPDX-License-Identifier: MIT
// Fields of a record that are members of a measurement. A child process sends them in the same form.
#pragma once

#include "harness/fields/field.h"
#include "harness/sampling/measurement.h"

namespace tandem::record_parts {

/// Counts of the checking replay, in `work`: what was found, and how much work it took.
const Fields<Measurement>& found_counts();
const Fields<Measurement>& effort_counts();

} // namespace tandem::record_parts
