// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/narrow_phase/contact_settings.h"
#include "backends/device.h"

#include <optional>
#include <string>

namespace tandem {

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
    switch (rule) {
    case ContactRule::clip:
        return {registers, in_double ? 2048 : 512};
    case ContactRule::sat:
    case ContactRule::restricted:
    case ContactRule::growth:
        return {registers, in_double ? 192 : 96};
    case ContactRule::vertex:
        return {registers, in_double ? 0 : 16}; // spills that NVRTC chooses in the layout `slots`
    default:
        return {registers, 0};
    }
}

/// Budget of the kernel that decides pairs and makes their contacts in one launch. It does the work of three
/// kernels, for small frames: with at most one pair per running work-item. There occupancy hardly matters, so
/// that it may use more registers. In double it may use all that a work-item can have, and the rest spills.
inline Budget at_once_budget(ContactRule rule, bool in_double) {
    switch (rule) {
    case ContactRule::clip:
        return in_double ? Budget{255, 2048} : Budget{168, 512};
    case ContactRule::sat:
    case ContactRule::restricted:
    case ContactRule::growth:
        return in_double ? Budget{255, 384} : Budget{168, 96};
    case ContactRule::opposing:
    case ContactRule::published:
        return in_double ? Budget{255, 96} : Budget{128, 0};
    default:
        return {in_double ? 255 : 128, 0};
    }
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
