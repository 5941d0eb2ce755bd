// SPDX-License-Identifier: MIT
#include "harness/verify/flaws.h"
#include "harness/record/parts.h"
#include "harness/sampling/statistics.h"

#include <algorithm>
#include <span>

namespace tandem::record_parts {

namespace {

Json spread_json(const std::vector<double>& samples) {
    const auto s = spread(samples);
    return s ? Json{{"median", s->median}, {"p99", s->p99}, {"max", s->maximum}} : Json();
}

/// Null where contacts were not compared with exact ones.
Json contact_errors_json(const AnswerErrors& e) {
    if (!e.contacts) return nullptr;
    const auto& c = *e.contacts;
    return {{"complete", e.every_contact},
            {"overlapping", c.overlapping},
            {"unanswered", c.unanswered},
            {"not_finite", c.not_finite},
            {"depth_relative", spread_json(c.depth_relative)},
            {"depth_ulps", spread_json(c.depth_ulps)},
            {"normal_degrees", spread_json(c.normal_degrees)},
            {"point", spread_json(c.point)},
            {"hausdorff", spread_json(c.hausdorff)},
            {"volume_relative", spread_json(c.volume_relative)},
            {"no_volume", c.no_volume}};
}

Json drift_json(const AnswerErrors& e) {
    if (!e.drift) return nullptr;
    const auto& d = *e.drift;
    return {{"vertices", d.vertices},
            {"median", d.median},
            {"p99", d.p99},
            {"max", d.max},
            {"of_bound", d.of_bound}};
}

Json truth_json(const AnswerErrors& e) {
    const auto upper = e.missed_upper95();
    const auto ratio = e.candidate_ratio();
    Json json{{"frames", e.frames},
              {"candidates", e.pairs.candidates},
              {"false", e.pairs.disjoint},
              {"touching", e.pairs.touching},
              {"overlapping", e.pairs.overlapping},
              {"invalid", e.pairs.invalid},
              {"missed_touching", e.pairs.missed_touching},
              {"missed_overlapping", e.pairs.missed_overlapping},
              {"missed_upper95", upper ? Json(*upper) : Json()},
              {"candidate_ratio", ratio ? Json(*ratio) : Json()},
              {"invalid_tetrahedra", e.invalid_tetrahedra}};
    for (unsigned tier = 0; tier < tier_count; ++tier)
        json["decided"][tier_names[tier]] = e.decided.tiers[tier];
    json["decisions"] = e.decisions ? Json(*e.decisions) : Json();
    json["contacts"] = contact_errors_json(e);
    json["drift"] = drift_json(e);
    return json;
}

/// Most bodies that a record lists; "flawed_bodies" is their full number.
constexpr std::size_t most_flawed_bodies = 16;

Json inputs_json(const Flaws& flaws) {
    Json bodies = Json::array();
    for (const auto& body : std::span(flaws.bodies).first(std::min(flaws.bodies.size(), most_flawed_bodies)))
        bodies.push_back({{"body", body.body},
                          {"degenerate", body.degenerate},
                          {"non_finite", body.non_finite},
                          {"frame", body.frame},
                          {"first", body.first}});
    return {{"handling", name_of(flaws.handling)},
            {"degenerate_elements", flaws.degenerate},
            {"non_finite_elements", flaws.non_finite},
            {"flawed_bodies", flaws.bodies.size()},
            {"bodies", bodies}};
}

} // namespace

Json error_json(const Measurement& m, const Flaws& flaws) {
    return {{"degenerate_pairs", m.degenerate},
            {"inputs", inputs_json(flaws)},
            {"truth", m.errors ? truth_json(*m.errors) : Json()}};
}

} // namespace tandem::record_parts
