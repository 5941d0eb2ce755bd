// SPDX-License-Identifier: MIT
#include "harness/record/parts.h"
#include "base/statistics.h"

namespace tandem::record_parts {

namespace {

struct DisturbedRound {
    std::uint32_t round;
    std::string why;
};

const Fields<DisturbedRound>& disturbed_fields() {
    static const Fields<DisturbedRound> fields{
        {"round", count(), "as in total_ns", &DisturbedRound::round},
        {"why", text(), "such as other work on the machine or throttled clocks", &DisturbedRound::why}};
    return fields;
}

Json disturbed_json(const Measurement& m) {
    std::vector<DisturbedRound> disturbed;
    for (const auto& round : m.conditions)
        if (const auto why = round.disturbed()) disturbed.push_back({round.round, *why});
    return array_json(disturbed_fields(), disturbed);
}

/// One reading of each round.
Json readings_json(const Measurement& m, Condition RoundConditions::*when) {
    std::vector<Condition> readings;
    for (const auto& round : m.conditions) readings.push_back(round.*when);
    return conditions_json(readings);
}

const Fields<Measurement>& round_condition_fields() {
    static const Fields<Measurement> fields{
        {"disturbed", array_of(disturbed_fields().type("one")), "rounds whose samples are doubtful",
         disturbed_json},
        {"before", condition_type(), "", [](auto& m) { return readings_json(m, &RoundConditions::before); }},
        {"after", condition_type(), "", [](auto& m) { return readings_json(m, &RoundConditions::after); }}};
    return fields;
}

std::vector<double> rounds_of(const CellRecord& r) { return round_medians(r.m.totals(), r.m.rounds()); }

/// Null where --repeat fixes the number of samples.
template<class Value>
Json unless_repeated(const CellRecord& r, const Value& value) {
    return r.sampling.criterion.repeat ? Json() : Json(value);
}

/// What was asked for.
Fields<CellRecord> request_fields() {
    return {{"cells",
             nullable(integer_from(1)),
             "cells of its group, which took turns in every round",
             [](auto& r) { return r.sampling.cells; },
             {.since = 3}},
            {"seed",
             known_count(),
             "of the order of cells in each round",
             [](auto& r) { return r.sampling.seed; },
             {.since = 3}},
            {"repeat", known_count(), "samples that were asked for; null where noise and seconds decide",
             [](auto& r) { return r.sampling.criterion.repeat; }},
            {"noise", nullable(number_above(0)),
             "width of the 95 % interval of the median, relative to it, that was asked for; null with repeat",
             [](auto& r) { return unless_repeated(r, noise_of(r.cell.devices, r.sampling.criterion)); }},
            {"seconds", nullable(number_above(0)), "after which ten rounds suffice; null with repeat",
             [](auto& r) { return unless_repeated(r, r.sampling.criterion.seconds); }}};
}

/// How it ended, and how good the samples are.
Fields<CellRecord> quality_fields() {
    return {{"spent_seconds",
             nullable(number_from(0)),
             "that its rounds took, preparations included",
             [](auto& r) { return static_cast<double>(r.outcome.sampler->state().spent_ns) * 1e-9; },
             {.since = 3}},
            {"converged",
             nullable(boolean()),
             "the interval became as narrow as that; null with repeat",
             [](auto& r) { return unless_repeated(r, r.outcome.converged); },
             {.column = "converged"}},
            {"interrupted", boolean(), "ended by a signal before it was sampled enough",
             [](auto& r) { return r.sampling.interrupted; }},
            {"continued",
             array_of(integer_from(0)),
             "rounds from which on another run of the program went on with --resume; the session is that of "
             "the last",
             [](auto& r) { return r.m.continued; },
             {.optional = true}},
            {"outliers", count(),
             "rounds more than five standard deviations, estimated by 1.4826 times the median absolute "
             "deviation, from "
             "the median (Hampel 1974)",
             [](auto& r) { return count_outliers(rounds_of(r)); }},
            {"drift", nullable(number()),
             "change of the rounds from first to last, relative to their median, where it has one direction "
             "(Mann 1945, p < 0.01; Sen 1968); null where it has none",
             [](auto& r) { return drift(rounds_of(r)); }}};
}

const Fields<CellRecord>& one_sampling() {
    static const auto fields =
        Fields<CellRecord>{{"rounds",
                            count(),
                            "rounds with samples; each prepared a session anew and warmed it up",
                            [](auto& r) { return rounds_of(r).size(); },
                            {.column = "rounds"}}}
            .with(request_fields())
            .with(quality_fields());
    return fields;
}

} // namespace

Fields<CellRecord> sampling_fields() {
    return {{"sampling", one_sampling().type("how the samples were taken, and what is to be thought of them"),
             "", [](auto& r) { return one_sampling().write(r); }},
            {"conditions",
             nullable(round_condition_fields().type(
                 "what the machine was like before and after the samples of each round; "
                 "null without samples")),
             "",
             [](auto& r) { return r.m.conditions.empty() ? Json() : round_condition_fields().write(r.m); },
             {.since = 3}}};
}

} // namespace tandem::record_parts
