// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"
#include "tests/support/contact_rules.h"

#include <optional>
#include <string>

namespace tandem {

using support::has_trait;

inline bool is_double(const Defines& defines) {
    return defines.contains("PRECISION") && defines.at("PRECISION") == "64";
}

/// What a kernel may use, for each precision.
struct Budget {
    int registers;
    int private_bytes; ///< of a work-item in device memory: stack and spills
};

/// Budget of the kernel that makes contacts: a quarter of a multiprocessor's work-items in float. Only rules
/// that search axes or cut polygons have private arrays in device memory. Rule clip has numbers of two words,
/// which spill in double.
inline Budget contacts_budget(ContactRule rule, bool in_double) {
    const int registers = in_double ? 192 : 128;
    if (has_trait(rule, TANDEM_CUTS_POLYGONS)) return {registers, in_double ? 2048 : 512};
    if (has_trait(rule, TANDEM_SEARCHES_AXES)) return {registers, in_double ? 192 : 96};
    // Spills that NVRTC chooses in the layout `slots`.
    return {registers, rule == ContactRule::vertex && !in_double ? 16 : 0};
}

/// Budget of the kernel that decides pairs and makes their contacts in one launch. It does the work of three
/// kernels, for small frames: with at most one pair per running work-item. There occupancy hardly matters, so
/// that it may use more registers. In double it may use all that a work-item can have, and the rest spills.
inline Budget at_once_budget(ContactRule rule, bool in_double) {
    const bool cuts = has_trait(rule, TANDEM_CUTS_POLYGONS), searches = has_trait(rule, TANDEM_SEARCHES_AXES);
    if (!in_double) return {cuts || searches ? 168 : 128, cuts ? 512 : searches ? 96 : 0};
    return {255, cuts ? 2048 : searches ? 384 : has_trait(rule, TANDEM_BOTH_BOUNDARY) ? 96 : 0};
}

/// Budget of a kernel of the contact stage. In float it is three eighths of a multiprocessor's work-items
/// for certificates, nearly half for the filter after them, and three sixteenths for the decision in double.
inline std::optional<Budget> budget_of(const std::string& name, const Defines& defines) {
    const bool in_double = is_double(defines);
    if (name == "certify_pairs") return in_double ? Budget{128, 0} : Budget{80, 0};
    if (name == "separate_pairs") return in_double ? Budget{240, 0} : Budget{96, 0};
    if (name == "recheck_pairs") return Budget{168, 400};
    if (name == "generate_contacts") {
        const auto rule = static_cast<ContactRule>(std::stoi(defines.at("CONTACT_RULE")));
        return defines.at("AT_ONCE") == "1" ? at_once_budget(rule, in_double)
                                            : contacts_budget(rule, in_double);
    }
    if (name != "filter_pairs") return std::nullopt;
    const bool certifies = !defines.contains("OVER_OPEN"); // without a list it starts with its certificates
    if (in_double) return Budget{certifies ? 168 : 132, 400};
    return Budget{certifies ? 80 : 72, 200};
}

} // namespace tandem
