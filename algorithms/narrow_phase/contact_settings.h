// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/table.h"

namespace tandem {

/// How contacts of a candidate pair are made, and what decides first whether it meets.
struct ContactSettings {
    ContactRule rule = ContactRule::opposing;
    DecisionPrecision decision = DecisionPrecision::fp32;

    bool operator==(const ContactSettings&) const = default;
};

/// Of resolved settings; the defaults when contact_rule=none.
ContactSettings contact_settings_of(const Settings& settings);

} // namespace tandem
