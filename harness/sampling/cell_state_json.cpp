// SPDX-License-Identifier: MIT
// Converts states of cells to JSON: lists the fields of every structure in a state.
#include "harness/sampling/cell_state.h"

#include "harness/verify/accuracy/answer_errors_json.h"

namespace tandem {

TANDEM_FIELDS(Digest, count, a, b)
TANDEM_FIELDS(StageSample, device_ns, host_ns, launches, waits, bytes)
TANDEM_FIELDS(KernelFacts, entry, defines, compile_ms, registers, local_bytes, spill_bytes, stack_bytes,
              max_group_size, occupancy)
TANDEM_FIELDS(KernelSample, device_ns, launches, stage, groups, group_size, facts)
TANDEM_FIELDS(HostWorkSample, host_ns, times, stage)
TANDEM_FIELDS(DeviceWork, bodies, body_pairs, pairs, ns, exchange_ns, exchange_bytes, messages)
TANDEM_FIELDS(TimedReplay, round, frame_ns, shared_ns, longest_ns, repartitions, rebuilds)
TANDEM_FIELDS(InstrumentedReplay, round, frame_ns, span_ns, stages, by_device, kernels, host_work, clocks)
TANDEM_FIELDS(ProcessorCondition, cores, quota, own, other_processes, governor, mhz, throttled, pressure)
TANDEM_FIELDS(GpuCondition, sm_mhz, sm_limit_mhz, memory_mhz, memory_limit_mhz, temperature_c, power_w,
              power_limit_w, throttle, busy_percent, processes)
TANDEM_FIELDS(Condition, processor, gpus)
TANDEM_FIELDS(RoundConditions, round, before, after)
TANDEM_FIELDS(DeepContact, frame, body_a, tet_a, body_b, tet_b, depth, size)
TANDEM_FIELDS(Flattened, tetrahedra, body, of_body)
TANDEM_FIELDS(Agreement, frames, missing, extra, contact_frames_wrong, digest, contact_digest)

namespace {

using nlohmann::json;

/// The items (replays or conditions) of round `first` and later rounds.
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

/// Uses the algorithm's own names as keys: their storage lives as long as the algorithm.
std::map<std::string_view, std::uint64_t> counted(const json& work, const Traversal& algorithm) {
    std::map<std::string_view, std::uint64_t> counts;
    for (const auto& counter : algorithm.counters())
        if (const auto found = work.find(counter.name); found != work.end())
            counts[counter.name] = found->get<std::uint64_t>();
    return counts;
}

/// Calls `each(name, value)` for every field that checking and counting set. The caller handles settings and
/// counts, whose names depend on the algorithm.
template<class State, class Each>
void each_checked(State& state, const Each& each) {
    auto& m = state.measurement;
    each("body_pairs", m.body_pairs);
    each("candidate_pairs", m.candidate_pairs);
    each("contacts", m.contacts);
    each("dropped_body_pairs", m.dropped_body_pairs);
    each("dropped_candidate_pairs", m.dropped_candidate_pairs);
    each("walked_tetrahedra", m.walked_tetrahedra);
    each("degenerate", m.degenerate);
    each("without_boundary", m.without_boundary);
    each("rejected", m.rejected);
    each("undecided_by_filter", m.undecided_by_filter);
    each("undecided_by_double", m.undecided_by_double);
    each("retries", m.retries);
    each("batches", m.batches);
    each("errors", m.errors);
    each("deep_contact", m.deep_contact);
    each("flattened", m.flattened);
    each("kernels", m.kernels);
    each("first_prepare_ns", m.prepare_ns);
    each("device_bytes", m.device_bytes);
    each("digests", state.digests);
    each("counted", state.counted);
}

/// Calls `each(name, value)` for every field that a round changes, other than the lists that it extends.
template<class State, class Each>
void each_of_round(State& state, const Each& each) {
    auto& m = state.measurement;
    each("continued", m.continued);
    each("submissions", m.submissions);
    each("shared", m.shared);
    each("agreement", m.agreement);
    each("replay_ns", state.replay_ns);
    each("prepare_ns", state.prepare_ns);
    each("spent_ns", state.spent_ns);
    each("rounds", state.rounds);
}

auto write_to(json& to) {
    return [&to](const char* name, const auto& value) { to[name] = value; };
}

auto read_from(const json& from) {
    return [&from](const char* name, auto& value) { from.at(name).get_to(value); };
}

} // namespace

json checked_json(const CellState& state) {
    const auto& m = state.measurement;
    json to{{"settings", m.settings.texts()}, {"work", named(m.work)}};
    each_checked(state, write_to(to));
    return to;
}

json rounds_json(const CellState& state, std::uint32_t first) {
    const auto& m = state.measurement;
    json to{{"samples", from_round(m.samples, first)},
            {"breakdowns", from_round(m.breakdowns, first)},
            {"conditions", from_round(m.conditions, first)}};
    each_of_round(state, write_to(to));
    return to;
}

void take_checked(CellState& state, const json& from, const Cell& cell) {
    auto& m = state.measurement;
    m.settings = resolve(cell.algorithm->parameters(), preset(*cell.algorithm, cell.preset).values,
                         from.at("settings").get<SettingTexts>(), cell.algorithm->name());
    m.work = counted(from.at("work"), *cell.algorithm);
    each_checked(state, read_from(from));
}

void take_rounds(CellState& state, const json& from) {
    auto& m = state.measurement;
    append(m.samples, from.at("samples"));
    append(m.breakdowns, from.at("breakdowns"));
    append(m.conditions, from.at("conditions"));
    each_of_round(state, read_from(from));
}

} // namespace tandem
