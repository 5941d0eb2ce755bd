// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/orders/order.h"
#include "algorithms/parameters/contact_rules.clh"
#include "algorithms/parameters/table.h"

namespace tandem {

/// How contacts of a candidate pair are made, how it is decided whether the pair meets, and the tetrahedra
/// and body pairs that pairs are found of.
struct ContactSettings {
    ContactRule rule = ContactRule::opposing;
    DecisionPrecision decision = DecisionPrecision::fp32;
    Walked walked = Walked::all;
    SelfPairs self = SelfPairs::off;
    double margin = 0;     ///< of rules with TANDEM_WITHIN_MARGIN
    bool closest = false;  ///< only the contact of each body pair with the least distance (output=distances)
    bool wrenches = false; ///< the polygons of each body pair added up (output=wrenches)
    bool within_sphere_boxes = false; ///< only pairs of bodies whose boxes overlap (broad=sphere_boxes)
    std::size_t first_body_pair = 0;  ///< the first of these body pairs, in ascending order
    std::size_t most_body_pairs = 0;  ///< and their number at most; 0: all

    bool operator==(const ContactSettings&) const = default;
};

/// Whether kernels that compute in double decide pairs, all or those without a certificate, before contacts
/// are made.
constexpr bool has_verdicts(DecisionPrecision decision) {
    return decision != DecisionPrecision::fp32 && decision != DecisionPrecision::none;
}

/// The define DECIDED of pair_state.clh. `by_verdicts`: the kernel reads verdicts.
constexpr const char* decided_define(DecisionPrecision decision, bool by_verdicts) {
    return decision == DecisionPrecision::none ? "2" : by_verdicts ? "1" : "0";
}

/// Whether `settings` give the same contacts for every k for which this is true: output=contacts, with
/// decision=exact and bounds that miss no pair that meets. The README of this folder has the proof. Throws
/// InputError as geometry_of().
bool contacts_are_equal_for_every_k(const Settings& settings);

/// The rule's margin as kernels and the reference have it: the least float that is not below it.
float margin_of(const ContactSettings& settings);

/// Contact settings of resolved settings; of contact_rule=none, only the tetrahedra that pairs are found of.
ContactSettings contact_settings_of(const Settings& settings);

} // namespace tandem
