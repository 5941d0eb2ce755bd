// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/contact_rules.clh"
#include "algorithms/parameters/table.h"

namespace tandem {

/// How contacts of a candidate pair are made, and how it is decided whether the pair meets.
struct ContactSettings {
    ContactRule rule = ContactRule::opposing;
    DecisionPrecision decision = DecisionPrecision::fp32;

    bool operator==(const ContactSettings&) const = default;
};

/// The traits of a rule, a sum of those of contact_rules.clh; 0 for none.
constexpr unsigned traits_of(ContactRule rule) {
    constexpr unsigned traits[] = {
#define TANDEM_TRAITS(word, traits, help) traits,
        TANDEM_CONTACT_RULES(TANDEM_TRAITS)
#undef TANDEM_TRAITS
            0};
    return traits[static_cast<unsigned>(rule)];
}

/// Number of the two tetrahedra of a pair that must have boundary faces for the rule to make contacts.
constexpr unsigned boundaries_needed(ContactRule rule) {
    const unsigned traits = traits_of(rule);
    return (traits & TANDEM_BOTH_BOUNDARY) != 0 ? 2 : (traits & TANDEM_ONE_BOUNDARY) != 0 ? 1 : 0;
}

/// Contact settings of resolved settings; the defaults when contact_rule=none.
ContactSettings contact_settings_of(const Settings& settings);

} // namespace tandem
