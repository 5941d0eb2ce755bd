// SPDX-License-Identifier: MIT
#include "algorithms/contacts/contact_settings.h"

#include <algorithm>

namespace tandem {

namespace {

const std::vector<Parameter> parameters{
    {"contact_rule",
     "opposing",
     {"opposing", "published", "sat", "clip", "restricted", "vertex", "consistent", "growth", "none"},
     0,
     0,
     "opposing: the paper's most opposing boundary faces; published: with its code's tolerances and gaps; "
     "sat: the least translation; clip: the intersection; restricted: sat along what boundary faces make; "
     "vertex: corners inside, nearest boundary face; consistent: the one their edges leave by; growth: what "
     "meets first when both grow"},
    {"decision",
     "fp32",
     {"fp32", "recheck", "fp64", "exact"},
     0,
     0,
     "whether a pair meets: fp32: separating axes in the cell's precision; recheck: a certified filter, then "
     "double; fp64: double; exact: then the oracle on the host"},
};

template<class Choice>
Choice choice_of(const Settings& settings, std::size_t index) {
    const auto& parameter = parameters[index];
    const auto& all = parameter.choices;
    return static_cast<Choice>(std::find(all.begin(), all.end(), settings.at(parameter.name)) - all.begin());
}

} // namespace

std::span<const Parameter> contact_parameters() { return parameters; }

ContactSettings contact_settings_of(const Settings& settings) {
    if (settings.at("contact_rule") == "none") return {};
    return {choice_of<ContactRule>(settings, 0), choice_of<DecisionPrecision>(settings, 1)};
}

} // namespace tandem
