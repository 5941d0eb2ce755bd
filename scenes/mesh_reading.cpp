// SPDX-License-Identifier: MIT
#include "scenes/mesh_reading.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tandem {

Duplicates duplicates_named(std::string_view name, std::string_view option) {
    const auto found = std::ranges::find(duplicates_names, name);
    if (found == duplicates_names.end())
        throw InputError(fmt::format("{} {}: give merge, keep or reject", option, name));
    return static_cast<Duplicates>(found - duplicates_names.begin());
}

double checked_weld(double tolerance, std::string_view option) {
    if (!std::isfinite(tolerance) || tolerance < 0)
        throw InputError(fmt::format("{} {}: give a finite tolerance of 0 or more", option, tolerance));
    return tolerance;
}

double checked_pressure(double modulus, std::string_view option) {
    if (!(modulus > 0 && modulus <= most_pressure))
        throw InputError(
            fmt::format("{} {}: give a modulus above 0, at most {:.2g}", option, modulus, most_pressure));
    return modulus;
}

} // namespace tandem
