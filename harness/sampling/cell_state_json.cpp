// SPDX-License-Identifier: MIT
// Converts states of cells to JSON: lists the fields of every structure in a state.
#include "harness/sampling/cell_state.h"

#include "harness/sampling/measurement_fields.h"
#include "harness/verify/accuracy/answer_errors_json.h"

namespace tandem {

TANDEM_FIELDS(Digest, count, a, b)
TANDEM_FIELDS(StageSample, device_ns, host_ns, launches, waits, bytes)
TANDEM_FIELDS(KernelFacts, entry, defines, compile_ms, registers, local_bytes, spill_bytes, stack_bytes,
              max_group_size, occupancy)
TANDEM_FIELDS(KernelSample, device_ns, launches, stage, groups, group_size, facts)
TANDEM_FIELDS(HostWorkSample, host_ns, times, stage)
TANDEM_FIELDS(PhaseSample, host_ns)
TANDEM_FIELDS(DeviceWork, bodies, body_pairs, pairs, ns, exchange_ns, exchange_bytes, messages)
TANDEM_FIELDS(TimedReplay, round, frame_ns, shared_ns, longest_ns, repartitions, rebuilds)
TANDEM_FIELDS(InstrumentedReplay, round, frame_ns, span_ns, stages, by_device, kernels, host_work, phases,
              clocks)
TANDEM_FIELDS(ProcessorCondition, cores, quota, own, other_processes, governor, mhz, throttled, pressure)
TANDEM_FIELDS(GpuCondition, sm_mhz, sm_limit_mhz, memory_mhz, memory_limit_mhz, temperature_c, power_w,
              power_limit_w, throttle, busy_percent, processes)
TANDEM_FIELDS(Condition, processor, gpus)
TANDEM_FIELDS(RoundConditions, round, before, after)
TANDEM_FIELDS(DeepContact, frame, body_a, tet_a, body_b, tet_b, depth, size)
TANDEM_FIELDS(Flattened, tetrahedra, body, of_body)
TANDEM_FIELDS(Agreement, frames, missing, extra, contact_frames_wrong, digest, contact_digest)

void to_json(nlohmann::ordered_json& to, const FrameCounts& counts) {
#define TANDEM_WRITE(member, ...) to[#member] = counts.member;
    TANDEM_FRAME_COUNTS(TANDEM_WRITE, TANDEM_WRITE)
#undef TANDEM_WRITE
}

void from_json(const nlohmann::ordered_json& from, FrameCounts& counts) {
#define TANDEM_TAKE(member, ...) from.at(#member).get_to(counts.member);
    TANDEM_FRAME_COUNTS(TANDEM_TAKE, TANDEM_TAKE)
#undef TANDEM_TAKE
}

namespace {

using OrderedJson = nlohmann::ordered_json;
using record_parts::Fields, record_parts::member;

/// The items (replays or conditions) of round `first` and later rounds.
template<class Item>
OrderedJson from_round(const std::vector<Item>& items, std::uint32_t first) {
    auto list = OrderedJson::array();
    for (const auto& item : items)
        if (item.round >= first) list.push_back(item);
    return list;
}

template<class Item>
void append(std::vector<Item>& items, const OrderedJson& more) {
    for (const auto& item : more) items.push_back(item.get<Item>());
}

std::map<std::string, std::uint64_t> named(const std::map<std::string_view, std::uint64_t>& work) {
    return {work.begin(), work.end()};
}

/// Uses the algorithm's own names as keys: their storage lives as long as the algorithm.
std::map<std::string_view, std::uint64_t> counted(const OrderedJson& work, const Traversal& algorithm) {
    std::map<std::string_view, std::uint64_t> counts;
    for (const auto& counter : algorithm.counters())
        if (const auto found = work.find(counter.name); found != work.end())
            counts[counter.name] = found->get<std::uint64_t>();
    return counts;
}

/// What checking and counting set, other than settings and counts whose names depend on the algorithm.
const Fields<Measurement>& checked_fields() {
    static const auto fields = record_parts::found_counts().with(
        {member("counts", &Measurement::counts), member("errors", &Measurement::errors),
         member("deep_contact", &Measurement::deep_contact), member("flattened", &Measurement::flattened),
         member("kernels", &Measurement::kernels), member("first_prepare_ns", &Measurement::prepare_ns),
         member("device_bytes", &Measurement::device_bytes)});
    return fields;
}

const Fields<CellState>& checked_state_fields() {
    static const Fields<CellState> fields{member("digests", &CellState::digests),
                                          member("counted", &CellState::counted)};
    return fields;
}

/// What a round changes, other than the lists that it extends.
const Fields<Measurement>& round_fields() {
    static const Fields<Measurement> fields{
        member("continued", &Measurement::continued), member("submissions", &Measurement::submissions),
        member("shared", &Measurement::shared), member("agreement", &Measurement::agreement)};
    return fields;
}

const Fields<CellState>& round_state_fields() {
    static const Fields<CellState> fields{
        member("replay_ns", &CellState::replay_ns), member("prepare_ns", &CellState::prepare_ns),
        member("spent_ns", &CellState::spent_ns), member("rounds", &CellState::rounds)};
    return fields;
}

} // namespace

OrderedJson checked_json(const CellState& state) {
    const auto& m = state.measurement;
    OrderedJson to{{"settings", m.settings.texts()}, {"work", named(m.work)}};
    to.update(checked_fields().write(m));
    to.update(checked_state_fields().write(state));
    return to;
}

OrderedJson rounds_json(const CellState& state, std::uint32_t first) {
    const auto& m = state.measurement;
    OrderedJson to{{"samples", from_round(m.samples, first)},
                   {"breakdowns", from_round(m.breakdowns, first)},
                   {"conditions", from_round(m.conditions, first)}};
    to.update(round_fields().write(m));
    to.update(round_state_fields().write(state));
    return to;
}

void take_checked(CellState& state, const OrderedJson& from, const Cell& cell) {
    auto& m = state.measurement;
    m.settings = resolve(cell.algorithm->parameters(), preset(*cell.algorithm, cell.preset).values,
                         from.at("settings").get<SettingTexts>(), cell.algorithm->name());
    m.work = counted(from.at("work"), *cell.algorithm);
    checked_fields().take(m, from);
    checked_state_fields().take(state, from);
}

void take_rounds(CellState& state, const OrderedJson& from) {
    auto& m = state.measurement;
    append(m.samples, from.at("samples"));
    append(m.breakdowns, from.at("breakdowns"));
    append(m.conditions, from.at("conditions"));
    round_fields().take(m, from);
    round_state_fields().take(state, from);
}

} // namespace tandem
