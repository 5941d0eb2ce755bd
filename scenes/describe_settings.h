// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/describe.h"

namespace tandem::description {

/// Gravity, step, solver and reduction of a description's dynamics over their defaults.
void read_settings(const Json& json, const JsonLocation& location, Dynamics& dynamics);

} // namespace tandem::description
