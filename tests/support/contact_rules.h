// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/narrow_phase/contact_settings.h"

#include <string>
#include <vector>

namespace tandem::support {

struct NamedRule {
    ContactRule rule;
    std::string name; ///< in --set and in records
};

/// Every contact rule except none, in the order of the setting.
inline std::vector<NamedRule> contact_rules() {
    std::vector<NamedRule> rules;
    for (const auto& word : parameters::contact_rule.choices())
        if (const auto rule = static_cast<ContactRule>(word.value); rule != ContactRule::none)
            rules.push_back({rule, std::string(word.text)});
    return rules;
}

/// Whether a rule has a trait of contact_rules.clh.
inline bool has_trait(ContactRule rule, unsigned trait) { return (traits_of(rule) & trait) != 0; }

/// Those whose contacts are points that two tetrahedra have in common.
inline std::vector<NamedRule> common_point_rules() {
    auto rules = contact_rules();
    std::erase_if(rules, [](const NamedRule& named) {
        return has_near_pairs(named.rule) || needs_pressures(named.rule);
    });
    return rules;
}

/// Those of them whose contacts do not depend on the order of the two tetrahedra and of their corners.
inline std::vector<ContactRule> canonical_contact_rules() {
    std::vector<ContactRule> rules;
    for (const auto& [rule, name] : common_point_rules())
        if (has_trait(rule, TANDEM_CANONICAL)) rules.push_back(rule);
    return rules;
}

} // namespace tandem::support
