// SPDX-License-Identifier: MIT
#include "harness/profile/timeline/timeline.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;

enum Lane { calls = 1, host_work, waits, stages, kernels, transfers, phases };
constexpr std::pair<Lane, const char*> lane_names[] = {
    {calls, "host: calls"},     {host_work, "host: own work"}, {waits, "host: waits"},
    {stages, "device: stages"}, {kernels, "device: kernels"},  {transfers, "device: transfers"},
    {phases, "host: phases"}};
constexpr const char* command_names[] = {"launch", "upload", "download", "clear", "wait"};

/// Event clocks have a resolution of half a microsecond, so an overlap of up to this length is a rounding
/// error.
constexpr std::int64_t rounding_ns = 1000;

bool has_device_times(const Event& event) { return event.begin_ns >= 0 && event.device_ns >= 0; }

/// The least offset of device times that no call contradicts, and the greatest that blocking calls allow.
struct Offset {
    std::optional<std::int64_t> least, most;
};

Offset offset_of(const Trace& trace) {
    Offset offset;
    for (const auto& e : trace.events) {
        if (!has_device_times(e)) continue;
        const auto begins = e.host_begin_ns - e.begin_ns;
        offset.least = offset.least ? std::max(*offset.least, begins) : begins;
        if (!e.blocked) continue;
        const auto ends = e.host_begin_ns + e.host_ns - e.begin_ns - e.device_ns;
        offset.most = offset.most ? std::min(*offset.most, ends) : ends;
    }
    return offset;
}

Json arguments_of(const Event& event) {
    Json json = Json::object();
    if (event.command != Command::phase) json["stage"] = stage_names[static_cast<std::size_t>(event.stage)];
    if (event.command == Command::launch) {
        json["groups"] = event.groups;
        json["group_size"] = event.group_size;
    } else if (event.command < Command::wait) {
        json["bytes"] = event.bytes;
    }
    return json;
}

/// Writes the events of one device.
class Writer {
public:
    Writer(Json& events, int process, std::int64_t zero) : events_(events), process_(process), zero_(zero) {}

    void name(const DeviceInfo& info) const;
    void calls_of(const Event& event);
    void device_of(const Trace& trace, std::int64_t offset);

private:
    /// Adds an event, in nanoseconds of the host's clock. A begin that overlaps the last end of the lane by a
    /// rounding error is set to that end.
    void add(Lane lane, const std::string& name, std::int64_t begin, std::int64_t length, Json arguments);

    Json& events_;
    int process_;
    std::int64_t zero_;
    std::int64_t ends_[phases + 1] = {};
};

void Writer::name(const DeviceInfo& info) const {
    events_.push_back({{"ph", "M"},
                       {"name", "process_name"},
                       {"pid", process_},
                       {"args", {{"name", info.id + " (" + info.name + ")"}}}});
    for (const auto& [lane, text] : lane_names) {
        events_.push_back({{"ph", "M"},
                           {"name", "thread_name"},
                           {"pid", process_},
                           {"tid", lane},
                           {"args", {{"name", text}}}});
        events_.push_back({{"ph", "M"},
                           {"name", "thread_sort_index"},
                           {"pid", process_},
                           {"tid", lane},
                           {"args", {{"sort_index", lane}}}});
    }
}

void Writer::add(Lane lane, const std::string& name, std::int64_t begin, std::int64_t length,
                 Json arguments) {
    auto& end = ends_[lane];
    if (begin < end && end - begin <= rounding_ns) {
        length = std::max<std::int64_t>(0, length - (end - begin));
        begin = end;
    }
    end = begin + length;
    const auto us = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-3; };
    events_.push_back({{"ph", "X"},
                       {"name", name},
                       {"pid", process_},
                       {"tid", lane},
                       {"ts", us(begin - zero_)},
                       {"dur", us(length)},
                       {"args", std::move(arguments)}});
}

void Writer::calls_of(const Event& event) {
    if (event.command > Command::wait) {
        const auto lane = event.command == Command::phase ? phases : host_work;
        add(lane, event.label, event.host_begin_ns, event.host_ns, arguments_of(event));
        return;
    }
    const auto text = std::string(command_names[static_cast<std::size_t>(event.command)]);
    add(calls, text + " " + event.label, event.host_begin_ns, event.host_ns, arguments_of(event));
    if (event.blocked)
        add(waits, text + " " + event.label, event.host_begin_ns, event.host_ns, arguments_of(event));
}

/// Commands run in order, so consecutive commands of one stage form one event of the stage lane.
void Writer::device_of(const Trace& trace, std::int64_t offset) {
    std::optional<Stage> stage;
    std::int64_t first = 0, last = 0;
    const auto end_stage = [&] {
        if (stage)
            add(stages, std::string(stage_names[static_cast<std::size_t>(*stage)]), first, last - first,
                Json::object());
    };
    for (const auto& event : trace.events) {
        if (!has_device_times(event)) continue;
        const auto begin = event.begin_ns + offset;
        const bool is_kernel = event.command == Command::launch;
        add(is_kernel ? kernels : transfers,
            is_kernel
                ? event.label
                : std::string(command_names[static_cast<std::size_t>(event.command)]) + " " + event.label,
            begin, event.device_ns, arguments_of(event));
        if (stage != event.stage) {
            end_stage();
            stage = event.stage;
            first = begin;
        }
        last = begin + event.device_ns;
    }
    end_stage();
}

Json offset_json(const Offset& offset) {
    const auto known = [](const auto& value) { return value ? Json(*value) : Json(); };
    return {{"offset_ns", known(offset.least)},
            {"at_most_ns", known(offset.most)},
            {"contradiction", offset.least && offset.most && *offset.least > *offset.most}};
}

} // namespace

Json timeline_json(std::span<const DeviceTimeline> devices, const std::string& cell, std::size_t frame) {
    auto zero = std::numeric_limits<std::int64_t>::max();
    for (const auto& device : devices)
        for (const auto& event : device.trace.events) zero = std::min(zero, event.host_begin_ns);
    Json events = Json::array(), clocks = Json::object();
    int process = 0;
    for (const auto& device : devices) {
        Writer writer(events, ++process, zero);
        writer.name(device.info);
        auto calls_in_order = device.trace.events;
        std::ranges::stable_sort(calls_in_order, {}, &Event::host_begin_ns);
        for (const auto& event : calls_in_order) writer.calls_of(event);
        const auto offset = offset_of(device.trace);
        if (offset.least) writer.device_of(device.trace, *offset.least);
        clocks[device.info.id] = offset_json(offset);
    }
    return {{"displayTimeUnit", "ns"},
            {"otherData",
             {{"cell", cell},
              {"frame", frame},
              {"clocks",
               "host time = device time + offset_ns, the least offset with which no command begins before "
               "the call that submitted it; blocking calls allow an offset up to at_most_ns"},
              {"commands", "each command is timed alone, so this frame is slower than a measured one"},
              {"devices", clocks}}},
            {"traceEvents", events}};
}

} // namespace tandem
