// SPDX-License-Identifier: MIT
#include "harness/frames/flaws.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem {

namespace {

constexpr std::array names{"flat", "skip", "reject"};

} // namespace

std::string_view name_of(Degenerate handling) { return names[static_cast<std::size_t>(handling)]; }

Degenerate degenerate_named(const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        throw InputError(fmt::format("--degenerate {}: give flat, skip or reject", name));
    return static_cast<Degenerate>(found - names.begin());
}

std::string describe(const Flaws& flaws, const Scene& scene) {
    std::vector<std::string> examples;
    for (const auto& body : flaws.bodies) {
        if (examples.size() == most_named_flaws) break;
        const bool more = body.degenerate + body.non_finite > body.first.size();
        examples.push_back(fmt::format("body {} tetrahedron {}{} in frame {}", body.body,
                                       fmt::join(body.first, ", "), more ? ", ..." : "", body.frame));
    }
    std::vector<std::string> counts;
    if (flaws.degenerate > 0) counts.push_back(fmt::format("{} of zero volume", flaws.degenerate));
    if (flaws.non_finite > 0) counts.push_back(fmt::format("{} not finite", flaws.non_finite));
    return fmt::format("{} in {} of {} bodies: {}{}", fmt::join(counts, " and "), flaws.bodies.size(),
                       scene.bodies.size(), fmt::join(examples, "; "),
                       flaws.bodies.size() > most_named_flaws ? "; ..." : "");
}

} // namespace tandem
