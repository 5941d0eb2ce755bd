// SPDX-License-Identifier: MIT
#include "harness/accuracy/answer_errors_json.h"

#include "harness/optional_json.h"

namespace tandem {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PairErrors, candidates, disjoint, touching, overlapping, invalid,
                                   missed_touching, missed_overlapping)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DecisionCounts, relations, tiers)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Drift, vertices, median, p99, max, of_bound)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ContactErrors, overlapping, unanswered, not_finite, depth_relative,
                                   depth_ulps, normal_degrees, point, hausdorff, volume_relative, no_volume)

void to_json(nlohmann::json& to, const AnswerErrors& e) {
    to = {{"frames", e.frames},       {"pairs", e.pairs},
          {"decided", e.decided},     {"invalid_tetrahedra", e.invalid_tetrahedra},
          {"decisions", e.decisions}, {"contacts", e.contacts},
          {"drift", e.drift},         {"every_contact", e.every_contact}};
}

void from_json(const nlohmann::json& from, AnswerErrors& e) {
    from.at("frames").get_to(e.frames);
    from.at("pairs").get_to(e.pairs);
    from.at("decided").get_to(e.decided);
    from.at("invalid_tetrahedra").get_to(e.invalid_tetrahedra);
    from.at("decisions").get_to(e.decisions);
    from.at("contacts").get_to(e.contacts);
    from.at("drift").get_to(e.drift);
    from.at("every_contact").get_to(e.every_contact);
}

} // namespace tandem
