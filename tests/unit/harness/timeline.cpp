// SPDX-License-Identifier: MIT
// Timelines of synthetic frames: clocks, lanes, and files that are complete or absent.
#include "harness/profile/timeline/timeline.h"
#include "base/error.h"
#include "tests/support/folder.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>

namespace tandem {
namespace {

using Json = nlohmann::ordered_json;

struct Span {
    std::int64_t begin, ns;
};

Event event(Command command, Stage stage, std::string label, Span host, Span device, bool blocked = false) {
    Event e;
    e.command = command;
    e.stage = stage;
    e.label = std::move(label);
    e.host_begin_ns = host.begin;
    e.host_ns = host.ns;
    e.begin_ns = device.begin;
    e.device_ns = device.ns;
    e.blocked = blocked;
    return e;
}

/// The device's clock is 5,000 behind if the upload begins at once; commands wait for each other.
DeviceTimeline frame() {
    DeviceTimeline timeline;
    timeline.info.id = "cuda:0";
    timeline.info.name = "GPU";
    timeline.trace.events = {
        event(Command::upload, Stage::write, "poses", {10'000, 500}, {5'000, 1'000}),
        event(Command::launch, Stage::refit, "refit_strips", {11'000, 500}, {6'500, 4'000}),
        event(Command::launch, Stage::refit, "refit_tops", {12'000, 500}, {10'499, 2'000}), // 1 ns too early
        event(Command::download, Stage::read, "status", {13'000, 9'000}, {13'000, 1'000}, true)};
    return timeline;
}

std::vector<Json> on_lane(const Json& timeline, int lane) {
    std::vector<Json> events;
    for (const auto& e : timeline.at("traceEvents"))
        if (e.at("ph") == "X" && e.at("tid") == lane) events.push_back(e);
    return events;
}

TEST(Timeline, PlacesCommandsAfterTheirCalls) {
    const std::vector<DeviceTimeline> devices{frame()};
    const auto json = timeline_json(devices, "a cell", 7);
    EXPECT_EQ(json["otherData"]["frame"], 7);
    EXPECT_EQ(json["otherData"]["devices"]["cuda:0"],
              (Json{{"offset_ns", 5000}, {"at_most_ns", 8000}, {"contradiction", false}}));
    const auto kernels = on_lane(json, 5);
    ASSERT_EQ(kernels.size(), 2u);
    EXPECT_EQ(kernels[0]["name"], "refit_strips");
    EXPECT_DOUBLE_EQ(kernels[0]["ts"], 1.5); // microseconds from the first call
    EXPECT_DOUBLE_EQ(kernels[0]["dur"], 4);
    EXPECT_DOUBLE_EQ(kernels[1]["ts"], 5.5); // shifted to compensate for rounding
    EXPECT_DOUBLE_EQ(kernels[1]["dur"], 1.999);
    EXPECT_EQ(kernels[0]["args"]["stage"], "refit");
    ASSERT_EQ(on_lane(json, 6).size(), 2u);
    EXPECT_EQ(on_lane(json, 1).size(), 4u);
    const auto waits = on_lane(json, 3);
    ASSERT_EQ(waits.size(), 1u);
    EXPECT_EQ(waits[0]["name"], "download status");
    const auto stages = on_lane(json, 4);
    ASSERT_EQ(stages.size(), 3u);
    EXPECT_EQ(stages[1]["name"], "refit");
    EXPECT_DOUBLE_EQ(stages[1]["ts"], 1.5);
    EXPECT_DOUBLE_EQ(stages[1]["dur"], 5.999);
}

TEST(Timeline, ReportsContradictingClocks) {
    std::vector<DeviceTimeline> devices{frame()};
    devices[0].trace.events[3].host_ns = 500; // ends before its command could
    EXPECT_EQ(timeline_json(devices, "", 0)["otherData"]["devices"]["cuda:0"]["contradiction"], true);
}

TEST(Timeline, WorksWithoutDeviceTimes) {
    std::vector<DeviceTimeline> devices{frame(), frame()};
    devices[1].info.id = "opencl:0";
    for (auto& e : devices[0].trace.events) e.begin_ns = e.device_ns = -1;
    const auto json = timeline_json(devices, "", 0);
    EXPECT_TRUE(json["otherData"]["devices"]["cuda:0"]["offset_ns"].is_null());
    EXPECT_EQ(on_lane(json, 5).size(), 2u);
    EXPECT_EQ(on_lane(json, 1).size(), 8u);
}

class TimelineFiles : public support::FolderTest {};

TEST_F(TimelineFiles, AreCompleteOrAbsent) {
    const auto path = this->path("trace.json");
    { const TimelineFile never_written(path); }
    EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(path).parent_path()));
    std::ofstream(path) << "before";
    TimelineFile file(path);
    file.write({{"traceEvents", Json::array()}});
    std::ifstream in(path);
    EXPECT_TRUE(Json::parse(in).contains("traceEvents"));
    EXPECT_THROW(TimelineFile(this->path("none/trace.json")), InputError);
    EXPECT_THROW(TimelineFile("/dev/null"), InputError);
    EXPECT_FALSE(TimelineFile(""));
}

} // namespace
} // namespace tandem
