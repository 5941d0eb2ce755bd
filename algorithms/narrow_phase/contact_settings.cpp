// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/contact_settings.h"

#include "algorithms/bounds/geometry.h"
#include "algorithms/parameters/table.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace tandem {

namespace {

/// A sum of two coordinates that is rounded to nearest is monotone, and so are the ends of its slabs. A sum
/// of three is rounded twice, and may miss pairs without a wider slab.
bool bounds_miss_nothing(const Geometry& geometry) {
    if (geometry.rounding != Rounding::nearest) return geometry.rounding != Rounding::published;
    return std::ranges::all_of(directions(geometry), [](const std::array<int, 3>& direction) {
        return std::abs(direction[0]) + std::abs(direction[1]) + std::abs(direction[2]) <= 2;
    });
}

} // namespace

bool contacts_are_equal_for_every_k(const Settings& settings) {
    return settings[parameters::output] == Output::contacts
           && settings[parameters::decision] == DecisionPrecision::exact
           && !has_near_pairs(settings[parameters::contact_rule])
           && !needs_pressures(settings[parameters::contact_rule])
           && bounds_miss_nothing(geometry_of(settings));
}

float margin_of(const ContactSettings& settings) {
    const auto nearest = static_cast<float>(settings.margin);
    return double{nearest} < settings.margin ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
                                             : nearest;
}

ContactSettings contact_settings_of(const Settings& settings) {
    ContactSettings result{.self = settings[parameters::self],
                           .within_sphere_boxes = settings[parameters::broad] == Broad::sphere_boxes};
    if (walks_part(settings)) {
        result.first_body_pair = static_cast<std::size_t>(settings[parameters::first_body_pair]);
        result.most_body_pairs = static_cast<std::size_t>(settings[parameters::most_body_pairs]);
    }
    if (settings[parameters::contact_rule] == ContactRule::none) return result;
    result.rule = settings[parameters::contact_rule];
    // A polygon is in both tetrahedra, so that nothing else decides.
    result.decision = needs_pressures(result.rule) ? DecisionPrecision::none : settings[parameters::decision];
    result.walked = walked_of(settings);
    if (has_near_pairs(result.rule)) result.margin = settings[parameters::margin];
    result.closest = settings[parameters::output] == Output::distances;
    result.wrenches = settings[parameters::output] == Output::wrenches;
    return result;
}

} // namespace tandem
