// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/table.h"

namespace tandem {

/// How contacts of a candidate pair are made, and how it is decided whether the pair meets.
struct ContactSettings {
    ContactRule rule = ContactRule::opposing;
    DecisionPrecision decision = DecisionPrecision::fp32;

    bool operator==(const ContactSettings&) const = default;
};

/// Contact settings of resolved settings; the defaults when contact_rule=none.
ContactSettings contact_settings_of(const Settings& settings);

} // namespace tandem
