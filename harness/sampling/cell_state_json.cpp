// SPDX-License-Identifier: MIT
// States of cells as JSON: a list of the fields of every structure in them.
#include "harness/sampling/cell_state.h"

#include "harness/accuracy/answer_errors_json.h"
#include "harness/optional_json.h"

namespace tandem {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Digest, count, a, b)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StageSample, device_ns, host_ns, launches, waits, bytes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(KernelSample, device_ns, launches)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimedReplay, round, frame_ns)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(InstrumentedReplay, round, frame_ns, span_ns, stages, kernels)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ProcessorCondition, cores, quota, own, others, governor, mhz, throttled,
                                   pressure)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(GpuCondition, sm_mhz, sm_limit_mhz, memory_mhz, memory_limit_mhz,
                                   temperature_c, power_w, power_limit_w, throttle, busy_percent, processes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Condition, processor, gpus)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RoundConditions, round, before, after)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Agreement, frames, missing, extra, contact_frames_wrong, digest,
                                   contact_digest)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(KernelFacts, entry, defines, compile_ms, registers, local_bytes,
                                   spill_bytes, max_group_size)

namespace {

using nlohmann::json;

/// Those of a vector of replays or conditions that were taken in a round from `first` on.
template<class Item>
json from_round(const std::vector<Item>& items, std::uint32_t first) {
    auto list = json::array();
    for (const auto& item : items)
        if (item.round >= first) list.push_back(item);
    return list;
}

template<class Item>
void append(std::vector<Item>& items, const json& more) {
    for (const auto& item : more) items.push_back(item.get<Item>());
}

std::map<std::string, std::uint64_t> named(const std::map<std::string_view, std::uint64_t>& work) {
    return {work.begin(), work.end()};
}

/// By the algorithm's own names, which live as long as it.
std::map<std::string_view, std::uint64_t> counted(const json& work, const Traversal& algorithm) {
    std::map<std::string_view, std::uint64_t> counts;
    for (const auto& counter : algorithm.counters())
        if (const auto found = work.find(counter.name); found != work.end())
            counts[counter.name] = found->get<std::uint64_t>();
    return counts;
}

} // namespace

json checked_json(const CellState& state) {
    const auto& m = state.measurement;
    return {{"settings", m.settings.texts()},
            {"body_pairs", m.body_pairs},
            {"candidate_pairs", m.candidate_pairs},
            {"contacts", m.contacts},
            {"degenerate", m.degenerate},
            {"rejected", m.rejected},
            {"undecided_by_filter", m.undecided_by_filter},
            {"undecided_by_double", m.undecided_by_double},
            {"retries", m.retries},
            {"batches", m.batches},
            {"submissions", m.submissions},
            {"work", named(m.work)},
            {"agreement", m.agreement},
            {"errors", m.errors},
            {"kernels", m.kernels},
            {"first_prepare_ns", m.prepare_ns},
            {"device_bytes", m.device_bytes},
            {"digests", state.digests},
            {"replay_ns", state.replay_ns},
            {"prepare_ns", state.prepare_ns},
            {"counted", state.counted}};
}

json rounds_json(const CellState& state, std::uint32_t first) {
    const auto& m = state.measurement;
    return {{"samples", from_round(m.samples, first)},
            {"breakdowns", from_round(m.breakdowns, first)},
            {"conditions", from_round(m.conditions, first)},
            {"continued", m.continued},
            {"submissions", m.submissions},
            {"agreement", m.agreement},
            {"replay_ns", state.replay_ns},
            {"prepare_ns", state.prepare_ns},
            {"spent_ns", state.spent_ns},
            {"rounds", state.rounds}};
}

void take_checked(CellState& state, const json& from, const Cell& cell) {
    auto& m = state.measurement;
    m.settings = resolve(cell.algorithm->parameters(), preset(*cell.algorithm, cell.preset).values,
                         from.at("settings").get<SettingTexts>(), cell.algorithm->name());
    from.at("body_pairs").get_to(m.body_pairs);
    from.at("candidate_pairs").get_to(m.candidate_pairs);
    from.at("contacts").get_to(m.contacts);
    from.at("degenerate").get_to(m.degenerate);
    from.at("rejected").get_to(m.rejected);
    from.at("undecided_by_filter").get_to(m.undecided_by_filter);
    from.at("undecided_by_double").get_to(m.undecided_by_double);
    from.at("retries").get_to(m.retries);
    from.at("batches").get_to(m.batches);
    from.at("submissions").get_to(m.submissions);
    m.work = counted(from.at("work"), *cell.algorithm);
    from.at("agreement").get_to(m.agreement);
    from.at("errors").get_to(m.errors);
    from.at("kernels").get_to(m.kernels);
    from.at("first_prepare_ns").get_to(m.prepare_ns);
    from.at("device_bytes").get_to(m.device_bytes);
    from.at("digests").get_to(state.digests);
    from.at("replay_ns").get_to(state.replay_ns);
    from.at("prepare_ns").get_to(state.prepare_ns);
    from.at("counted").get_to(state.counted);
}

void take_rounds(CellState& state, const json& from) {
    auto& m = state.measurement;
    append(m.samples, from.at("samples"));
    append(m.breakdowns, from.at("breakdowns"));
    append(m.conditions, from.at("conditions"));
    from.at("continued").get_to(m.continued);
    from.at("submissions").get_to(m.submissions);
    from.at("agreement").get_to(m.agreement);
    from.at("replay_ns").get_to(state.replay_ns);
    from.at("prepare_ns").get_to(state.prepare_ns);
    from.at("spent_ns").get_to(state.spent_ns);
    from.at("rounds").get_to(state.rounds);
}

} // namespace tandem
