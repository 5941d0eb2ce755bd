// SPDX-License-Identifier: MIT
#include "harness/record/parts.h"
#include "harness/plans/cell_session.h"
#include "base/statistics.h"

namespace tandem::record_parts {

namespace {

/// One of several devices.
struct DevicePart {
    const Measurement& m;
    std::size_t device;
    std::string id;

    /// One value in every frame of the last sample.
    Json by_frame(std::uint64_t DeviceWork::*member) const {
        Json json = Json::array();
        for (const auto& frame : m.shared) json.push_back(frame[device].*member);
        return json;
    }
};

struct PartTimes {
    std::vector<std::int64_t> samples;
    Summary statistics;
};

const Fields<PartTimes>& part_times_fields() {
    static const Fields<PartTimes> fields{
        {"samples", array_of(count()).with("minItems", 1), "one a replay", &PartTimes::samples},
        {"median", number(), "of the samples", [](auto& t) { return t.statistics.median; }},
        {"low", number(), "lower end of the 95 % bootstrap interval of the median",
         [](auto& t) { return t.statistics.low; }},
        {"high", number(), "its upper end", [](auto& t) { return t.statistics.high; }}};
    return fields;
}

/// Times by replay, by the host's clock, within the span that total_ns measures.
Json part_times_json(const DevicePart& part) {
    PartTimes times;
    std::vector<std::uint32_t> rounds;
    for (const auto& sample : part.m.samples) {
        times.samples.push_back(sample.shared_ns[part.device]);
        rounds.push_back(sample.round);
    }
    times.statistics = summarise(times.samples, rounds);
    return part_times_fields().write(times);
}

struct StageMedians {
    double device_ns, host_ns;
};

const Fields<StageMedians>& part_stage_fields() {
    static const Fields<StageMedians> fields{
        {"device_ns", number(), "sum of the commands' device times", &StageMedians::device_ns},
        {"host_ns", number(), "host time in the calls", &StageMedians::host_ns}};
    return fields;
}

/// Medians of the instrumented replays, without stages that took no time.
Json part_stages_json(const DevicePart& part) {
    Json json = Json::object();
    for (std::size_t stage = 0; stage < stage_names.size(); ++stage) {
        std::vector<std::int64_t> on_device, on_host;
        for (const auto& replay : part.m.breakdowns) {
            on_device.push_back(replay.by_device[part.device][stage].device_ns);
            on_host.push_back(replay.by_device[part.device][stage].host_ns);
        }
        const auto host = on_host.empty() ? 0.0 : summarise(on_host).median;
        if (host <= 0) continue;
        json[std::string(stage_names[stage])] =
            part_stage_fields().write({summarise(on_device).median, host});
    }
    return json;
}

const Fields<DeviceWork>& exchange_fields() {
    static const Fields<DeviceWork> fields{
        {"host_ns", count(), "passing them, and waiting for them", &DeviceWork::exchange_ns},
        {"bytes", count(), "sent", &DeviceWork::exchange_bytes},
        {"messages", count(), "sent", &DeviceWork::messages}};
    return fields;
}

/// Sums over the frames of the last sample; null without an exchange.
Json exchange_json(const DevicePart& part) {
    DeviceWork sum;
    for (const auto& frame : part.m.shared) {
        sum.exchange_ns += frame[part.device].exchange_ns;
        sum.exchange_bytes += frame[part.device].exchange_bytes;
        sum.messages += frame[part.device].messages;
    }
    return sum.exchange_ns == 0 ? Json() : exchange_fields().write(sum);
}

const Fields<DevicePart>& part_fields() {
    static const Fields<DevicePart> fields{
        {"device", text(), "its id", &DevicePart::id},
        {"ns",
         part_times_fields().type("host nanoseconds from the start of its part of a frame to its answer, "
                                  "over the frames of a replay"),
         "", part_times_json},
        {"bodies", array_of(count()), "placed and bounded in each frame, whoever owns them",
         [](auto& p) { return p.by_frame(&DeviceWork::bodies); }},
        {"body_pairs", array_of(count()), "walked in each frame",
         [](auto& p) { return p.by_frame(&DeviceWork::body_pairs); }},
        {"candidate_pairs", array_of(count()), "found in each frame",
         [](auto& p) { return p.by_frame(&DeviceWork::pairs); }},
        {"exchange",
         nullable(exchange_fields().type(
             "messages between ranks of a job, over the frames of the last sample; null without ranks")),
         "", exchange_json},
        {"stages", map_of(part_stage_fields().type("of one stage"), ""),
         "by stage, over the frames of a replay: medians of the instrumented replays", part_stages_json}};
    return fields;
}

double imbalance_of(const CellRecord& r) {
    std::vector<double> imbalances;
    for (const auto& sample : r.m.samples) imbalances.push_back(sample.imbalance().value_or(1));
    std::ranges::sort(imbalances);
    return imbalances[imbalances.size() / 2];
}

Json parts_json(const CellRecord& r) {
    const auto infos = infos_of(r.cell);
    std::vector<DevicePart> parts;
    for (std::size_t i = 0; i < r.m.shared.front().size(); ++i) parts.push_back({r.m, i, infos[i].id});
    return array_json(part_fields(), parts);
}

const Fields<CellRecord>& division_fields() {
    static const Fields<CellRecord> fields{
        {"imbalance", number_from(1),
         "the longest of the devices over the mean of all, frame by frame, over a replay: 1 where all end "
         "together; the median of the samples",
         imbalance_of},
        {"repartitions", count(),
         "frames of the last sample before which bodies were assigned to the devices again",
         [](auto& r) { return r.m.samples.back().repartitions; }},
        {"devices", array_of(part_fields().type("what one of them did")).with("minItems", 2),
         "in the order of devices: of ranks in theirs", parts_json}};
    return fields;
}

} // namespace

Fields<CellRecord> partition_fields() {
    return {
        {"partition",
         nullable(division_fields().type("how the frames were divided between several devices; null on one "
                                         "device; absent in older records")),
         "",
         [](auto& r) {
             return r.m.samples.empty() || r.m.shared.empty() ? Json() : division_fields().write(r);
         },
         {.optional = true}}};
}

} // namespace tandem::record_parts
