// SPDX-License-Identifier: MIT
#include "harness/record/parts.h"
#include "harness/sampling/statistics.h"

namespace tandem::record_parts {

Json conditions_json(const Measurement& m) {
    if (m.conditions.empty()) return nullptr;
    Json disturbed = Json::array();
    std::vector<Condition> before, after;
    for (const auto& round : m.conditions) {
        if (const auto why = round.disturbed()) disturbed.push_back({{"round", round.round}, {"why", *why}});
        before.push_back(round.before);
        after.push_back(round.after);
    }
    return {{"disturbed", disturbed}, {"before", conditions_json(before)}, {"after", conditions_json(after)}};
}

Json sampling_json(const Measurement& m, const Cell& cell, const Outcome& outcome, const Sampling& sampling) {
    const auto rounds = round_medians(m.totals(), m.rounds());
    const auto change = drift(rounds);
    const auto& criterion = sampling.criterion;
    return {{"rounds", rounds.size()},
            {"cells", sampling.cells},
            {"seed", sampling.seed},
            {"repeat", criterion.repeat ? Json(*criterion.repeat) : Json()},
            {"noise", criterion.repeat ? Json() : Json(noise_of(cell.devices, criterion))},
            {"seconds", criterion.repeat ? Json() : Json(criterion.seconds)},
            {"spent_seconds", static_cast<double>(outcome.sampler->state().spent_ns) * 1e-9},
            {"converged", criterion.repeat ? Json() : Json(outcome.converged)},
            {"interrupted", sampling.interrupted},
            {"continued", m.continued},
            {"outliers", count_outliers(rounds)},
            {"drift", change ? Json(*change) : Json()}};
}

} // namespace tandem::record_parts
