// SPDX-License-Identifier: MIT
#include "harness/record/parts.h"
#include "base/statistics.h"
#include "harness/frames/flaws.h"

#include <algorithm>
#include <span>

namespace tandem::record_parts {

namespace {

const Fields<Spread>& spread_fields() {
    static const Fields<Spread> fields{{"median", number_from(0), "", &Spread::median},
                                       {"p99", number_from(0), "", &Spread::p99},
                                       {"max", number_from(0), "", &Spread::maximum}};
    return fields;
}

/// A field with the spread of samples of compared contacts.
Field<AnswerErrors> spread_field(const std::string& name, const std::string& meaning,
                                 std::vector<double> ContactErrors::*samples) {
    static const auto type =
        definition("spread", nullable(spread_fields().type("over samples; null without any")));
    return {name, type, meaning, [samples](const AnswerErrors& e) {
                const auto s = spread((*e.contacts).*samples);
                return s ? spread_fields().write(*s) : Json();
            }};
}

Fields<AnswerErrors> contact_counts() {
    return {
        {"complete", boolean(), "all overlapping pairs of all frames; false: a sample of them",
         &AnswerErrors::every_contact},
        {"overlapping", count(), "pairs compared", [](auto& e) { return e.contacts->overlapping; }},
        {"unanswered", count(), "of these without a contact", [](auto& e) { return e.contacts->unanswered; }},
        {"not_finite", count(), "contacts with a number that is not finite",
         [](auto& e) { return e.contacts->not_finite; }}};
}

Fields<AnswerErrors> contact_spreads() {
    auto volume = spread_field("volume_relative",
                               "|hull - exact| / exact: volume of the contact points' convex hull against "
                               "that of the exact intersection, "
                               "whose vertices the points of every rule are; 1 where the points span none",
                               &ContactErrors::volume_relative);
    volume.occurrence.since = 4;
    auto distance = spread_field(
        "distance_ulps", "|distance - exact| / (u L) of pairs that are apart, of contact_rule=distance",
        &ContactErrors::distance_ulps);
    distance.occurrence.optional = true;
    auto polygon =
        spread_field("polygon_ulps",
                     "|area - exact| / (u L^2) of pairs with a polygon of equal pressure in the answer or "
                     "exactly, of contact_rule=pressure",
                     &ContactErrors::polygon_ulps);
    polygon.occurrence.optional = true;
    return {spread_field("depth_relative",
                         "|deepest - exact| / exact, the exact depth that of the least translation",
                         &ContactErrors::depth_relative),
            spread_field("depth_ulps",
                         "|deepest - exact| / (u L): u half the distance from 1 to the next number of the "
                         "precision, L the longest edge",
                         &ContactErrors::depth_ulps),
            spread_field("normal_degrees", "angle of the deepest contact's normal to the nearest optimal one",
                         &ContactErrors::normal_degrees),
            spread_field("point", "farthest contact point from the exact intersection / L",
                         &ContactErrors::point),
            spread_field("hausdorff",
                         "Hausdorff distance of contact points and the exact intersection's vertices / L",
                         &ContactErrors::hausdorff),
            volume,
            distance,
            polygon};
}

/// Fields of answers that have contacts.
const Fields<AnswerErrors>& contact_fields() {
    static const auto fields =
        contact_counts()
            .with(contact_spreads())
            .with({{"no_volume",
                    count(),
                    "answered pairs whose exact volume rounds to 0, which have no relative error of it",
                    [](auto& e) { return e.contacts->no_volume; },
                    {.optional = true}}});
    return fields;
}

const Fields<Drift>& drift_fields() {
    static const Fields<Drift> fields{{"vertices", count(), "", &Drift::vertices},
                                      {"median", number_from(0), "", &Drift::median},
                                      {"p99", number_from(0), "", &Drift::p99},
                                      {"max", number_from(0), "", &Drift::max},
                                      {"of_bound", number_from(0),
                                       "largest share of its proven bound that a vertex uses; at most 1",
                                       &Drift::of_bound}};
    return fields;
}

const Fields<DecisionCounts>& tier_fields() {
    static const auto fields = [] {
        std::vector<Field<DecisionCounts>> tiers;
        for (unsigned i = 0; i < tier_count; ++i)
            tiers.push_back({tier_names[i], count(), "", [i](const auto& d) { return d.tiers[i]; }});
        return Fields<DecisionCounts>(std::move(tiers));
    }();
    return fields;
}

Fields<AnswerErrors> pair_fields() {
    return {{"frames", integer_from(1), "frames compared", &AnswerErrors::frames},
            {"candidates", count(), "candidate pairs", [](auto& e) { return e.pairs.candidates; }},
            {"false", count(), "candidate pairs that are disjoint", [](auto& e) { return e.pairs.disjoint; }},
            {"touching", count(), "candidate pairs with common points, none inside both",
             [](auto& e) { return e.pairs.touching; }},
            {"overlapping", count(), "candidate pairs with a point inside both",
             [](auto& e) { return e.pairs.overlapping; }},
            {"invalid", count(), "candidate pairs with a coordinate that is not finite",
             [](auto& e) { return e.pairs.invalid; }},
            {"missed_touching", count(), "touching pairs that are no candidates",
             [](auto& e) { return e.pairs.missed_touching; }},
            {"missed_overlapping", count(), "overlapping pairs that are no candidates",
             [](auto& e) { return e.pairs.missed_overlapping; }},
            {"missed_upper95", nullable(number_from(0)).with("maximum", 1),
             "with 95 % confidence the share of meeting pairs missed is at most this, when none was missed: "
             "3 / n; null otherwise",
             &AnswerErrors::missed_upper95},
            {"candidate_ratio", nullable(number_from(0)),
             "candidates per pair that meets; null when none does", &AnswerErrors::candidate_ratio},
            {"invalid_tetrahedra", count(),
             "tetrahedra with a coordinate that is not finite, over all frames",
             &AnswerErrors::invalid_tetrahedra}};
}

Type three_of(const Type& type) { return array_of(type).with("minItems", 3).with("maxItems", 3); }

const Fields<AnswerErrors>& truth_fields() {
    static const auto fields = pair_fields().with(
        {{"decided", tier_fields().type("pairs whose boxes meet, by which tier of the oracle decided them"),
          "", [](auto& e) { return tier_fields().write(e.decided); }},
         {"decisions", nullable(three_of(three_of(count()))),
          "rows: exactly disjoint (candidates only), touching, overlapping; columns: answered by no contact, "
          "contacts of depth 0, a contact inside; null without contacts",
          &AnswerErrors::decisions},
         {"contacts",
          nullable(
              contact_fields().type("contacts of overlapping pairs against their exact intersections, one "
                                    "sample a pair; null when not asked for")),
          "", [](auto& e) { return e.contacts ? contact_fields().write(e) : Json(); }},
         {"drift",
          nullable(drift_fields().type("how far the first frame's vertices are from where the poses put them "
                                       "exactly, in ulps of a vertex's "
                                       "largest coordinate; null when contacts were not asked for")),
          "", [](auto& e) { return e.drift ? drift_fields().write(*e.drift) : Json(); }}});
    return fields;
}

/// Most bodies that a record lists; "flawed_bodies" is their full number.
constexpr std::size_t most_flawed_bodies = 16;

const Fields<FlawedBody>& flawed_body_fields() {
    static const Fields<FlawedBody> fields{
        {"body", count(), "its number", &FlawedBody::body},
        {"degenerate", count(), "its tetrahedra of zero volume, over all frames", &FlawedBody::degenerate},
        {"non_finite", count(), "its tetrahedra that are not finite, over all frames",
         &FlawedBody::non_finite},
        {"frame", count(), "the first frame with any of them", &FlawedBody::frame},
        {"first", array_of(count()).with("minItems", 1).with("maxItems", most_named_flaws),
         "the first of them in that frame, by number", &FlawedBody::first}};
    return fields;
}

const Fields<Flaws>& input_fields() {
    static const Fields<Flaws> fields{
        {"handling", one_of({"flat", "skip", "reject"}),
         "--degenerate. flat: those of zero volume take part; skip: no flawed one does, in the answer, the "
         "reference or the truth; reject: there are none",
         [](auto& f) { return name_of(f.handling); }},
        {"degenerate_elements", count(), "tetrahedra of zero volume, over all bodies and frames",
         &Flaws::degenerate},
        {"non_finite_elements", count(),
         "tetrahedra with a coordinate that is not finite, over all bodies and frames", &Flaws::non_finite},
        {"flawed_bodies", count(), "bodies with any of them", [](auto& f) { return f.bodies.size(); }},
        {"bodies", array_of(flawed_body_fields().type("one body")).with("maxItems", most_flawed_bodies),
         "the first of these bodies, by number", [](auto& f) {
             const auto shown = std::min(f.bodies.size(), most_flawed_bodies);
             return array_json(flawed_body_fields(), std::span(f.bodies).first(shown));
         }}};
    return fields;
}

const Fields<RoundingErrors>& rounding_fields() {
    static const Fields<RoundingErrors> fields{
        {"meeting", count(), "pairs that meet by the input", &RoundingErrors::meeting},
        {"lost",
         count(),
         "of these, pairs that do not meet by the vertices that setting placement names: rounding lost them, "
         "whatever the answer; 0 with placement=exact",
         &RoundingErrors::lost,
         {.column = "rounding_lost"}},
        {"extra",
         count(),
         "pairs that meet by those vertices and not by the input",
         &RoundingErrors::extra,
         {.column = "rounding_extra"}},
        {"missed", count(), "pairs that meet by the input and are no candidates of the answer",
         &RoundingErrors::missed},
        {"depth_change",
         nullable(number_from(0)),
         "largest difference of a pair's exact depths by the cell's vertices and by the input, in units of "
         "the "
         "scene, 0 being the depth of a pair that does not overlap; of as many pairs as "
         "error.truth.contacts; "
         "null when contacts were not asked for",
         &RoundingErrors::depth_change,
         {.column = "rounding_depth_change"}}};
    return fields;
}

const Fields<DeepContact>& deep_contact_fields() {
    static const Fields<DeepContact> fields{
        {"frame", count(), "its frame", &DeepContact::frame},
        {"body_a", count(), "the first body, by number", &DeepContact::body_a},
        {"tet_a", count(), "its tetrahedron", &DeepContact::tet_a},
        {"body_b", count(), "the second body", &DeepContact::body_b},
        {"tet_b", count(), "its tetrahedron", &DeepContact::tet_b},
        {"depth", number(), "in the scene's unit of length; negative, as inside", &DeepContact::depth},
        {"size", number_from(0), "diagonal of the box around the smaller body, in the same unit",
         &DeepContact::size}};
    return fields;
}

auto truth_type() {
    return nullable(truth_fields().type(
        "against the exact truth, every pair of every frame decided, by the vertices that setting "
        "placement names (rounded: the cell's, moved in its precision; exact: the scene's, moved "
        "without rounding; decisions and contacts were judged by the cell's before there was a "
        "setting origin); null when not asked for"));
}

const Fields<CellRecord>& one_error() {
    static const Fields<CellRecord> fields{
        {"degenerate_pairs", count(),
         "candidate pairs without contacts because a tetrahedron has no certain volume, over all frames",
         [](auto& r) { return r.m.counts.degenerate; }},
        {"deep_contact",
         nullable(deep_contact_fields().type("deepest contact of the first frame with contacts deeper than "
                                             "the smaller body is long, with a rule "
                                             "that needs boundary faces of both; null: none, or unchecked")),
         "",
         [](auto& r) { return r.m.deep_contact ? deep_contact_fields().write(*r.m.deep_contact) : Json(); },
         {.since = 4}},
        {"flattened",
         count(),
         "tetrahedra with volume that have none by the vertices as the device has them, in the first "
         "frame; 0 when answers were not checked",
         [](auto& r) { return r.m.flattened.tetrahedra; },
         {.since = 4, .column = "flattened"}},
        {"inputs",
         input_fields().type(
             "flawed tetrahedra of the frames as they were given: of exactly zero volume, or with "
             "a coordinate that is not finite"),
         "",
         [](auto& r) { return input_fields().write(r.range.flaws()); },
         {.since = 4}},
        {"truth",
         truth_type(),
         "",
         [](auto& r) { return r.m.errors ? truth_fields().write(*r.m.errors) : Json(); },
         {.since = 4}},
        {"rounding",
         nullable(rounding_fields().type(
             "against the input: the scene's vertices in double, moved by the poses without rounding, every "
             "pair of every frame decided. What the rounding of vertices to the cell's changed; null without "
             "a truth, and with motion=linear")),
         "",
         [](auto& r) {
             return r.m.errors && r.m.errors->rounding ? rounding_fields().write(*r.m.errors->rounding)
                                                       : Json();
         },
         {.since = 4}}};
    return fields;
}

} // namespace

Fields<CellRecord> error_fields() {
    return {{"error", nullable(one_error().type("how far the answer is from the geometric truth")), "",
             [](auto& r) { return r.is_measured() ? one_error().write(r) : Json(); }}};
}

} // namespace tandem::record_parts
