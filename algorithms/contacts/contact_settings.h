// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/settings.h"

#include <array>

namespace tandem {

/// How contacts are made of a pair that meets (setting contact_rule). README.md has the rules.
enum class ContactRule { opposing, published, sat, clip, restricted, vertex, consistent, growth };

/// What decides whether a pair meets (setting decision).
enum class DecisionPrecision {
    fp32,    ///< separating axes in the cell's precision; what they do not tell apart meets
    recheck, ///< a certified filter in the cell's precision, then double for what it is unsure of
    fp64,    ///< the certified decision in double for all pairs
    exact    ///< as recheck, then the exact oracle for what double is unsure of
};

struct ContactSettings {
    ContactRule rule = ContactRule::opposing;
    DecisionPrecision decision = DecisionPrecision::fp32;

    bool operator==(const ContactSettings&) const = default;
};

/// The settings above as every algorithm declares them.
std::span<const Parameter> contact_parameters();

/// Of resolved settings; the defaults when contact_rule=none.
ContactSettings contact_settings_of(const Settings& settings);

} // namespace tandem
