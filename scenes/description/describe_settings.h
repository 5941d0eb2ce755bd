// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/description/describe.h"

namespace tandem::description {

/// Overwrites gravity, step, solver and reduction in `dynamics` by the values of a description.
void read_settings(const Json& json, const JsonLocation& location, Dynamics& dynamics);

} // namespace tandem::description
