// SPDX-License-Identifier: MIT
// Baselines are opt-in: found by name, in no list of all algorithms. Their answers equal those of the
// project's own algorithms; unsupported settings are rejected.
#include "algorithms/baselines/cubql/build.h"
#include "backends/host/host_device.h"
#include "scenes/builtin.h"
#include "base/error.h"
#include "scenes/hard/hard.h"
#include "tests/support/cells.h"
#include "tests/support/flawed.h"
#include "tests/support/message_of.h"
#include "tests/support/sanitized.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::HasSubstr;

const Traversal& embree() { return algorithm("embree"); }

Settings of_first_preset(const Traversal& traversal, const SettingTexts& given) {
    return resolve(traversal.parameters(), traversal.presets().front().values, given, traversal.name());
}

/// Why a device rejects these settings; "no error" if it accepts them.
std::string rejection(const DeviceInfo& info, const SettingTexts& given,
                      const Traversal& traversal = embree()) {
    return message_of([&] { traversal.fitted(of_first_preset(traversal, given), info); });
}

/// Whether the program was built without Embree.
bool is_absent() {
    return rejection(device("host").info(), {}).find("built without Embree") != std::string::npos;
}

TEST(Baselines, AreFoundByNameAndInNoList) {
    ASSERT_FALSE(baselines().empty());
    for (const auto* baseline : baselines()) {
        EXPECT_EQ(&algorithm(baseline->name()), baseline);
        for (const auto* traversal : algorithms()) EXPECT_NE(traversal, baseline);
        EXPECT_THROW(add_algorithm(*baseline), InputError);
    }
}

TEST(Baselines, RejectUnsupportedSettings) {
    const auto& host = device("host").info();
    if (is_absent()) {
        EXPECT_THAT(rejection(host, {}), HasSubstr("install Debian's libembree-dev"));
        EXPECT_THAT(std::string(embree().summary()), HasSubstr("install Debian's libembree-dev"));
        return;
    }
    auto other = host;
    other.id = "cuda:9";
    EXPECT_EQ(rejection(host, {}), "no error");
    EXPECT_THAT(rejection(other, {}), HasSubstr("device host only, not on cuda:9"));
    EXPECT_THAT(rejection(host, {{"k", "18"}}), HasSubstr("choose k=6"));
    EXPECT_THAT(rejection(host, {{"precision", "double"}}), HasSubstr("choose float"));
    const std::array both{&device("host"), &device("opencl:0")};
    EXPECT_THROW(embree().check(both, of_first_preset(embree(), {})), InputError);
}

/// With the facts of a device that need not exist.
TEST(Baselines, CubqlRejectsUnsupportedSettings) {
    const auto& cubql = algorithm("cubql");
    DeviceInfo cuda;
    cuda.id = "cuda:9";
    cuda.is_gpu = true;
    cuda.max_group_size = 1024;
    if (*cubql_trees::query_ptx == '\0') {
        EXPECT_THAT(rejection(cuda, {}, cubql), HasSubstr("clone github.com/NVIDIA/cuBQL"));
        EXPECT_THAT(std::string(cubql.summary()), HasSubstr("clone github.com/NVIDIA/cuBQL"));
        return;
    }
    EXPECT_EQ(rejection(cuda, {}, cubql), "no error");
    EXPECT_THAT(rejection(device("host").info(), {}, cubql), HasSubstr("CUDA devices only, not on host"));
    const std::vector<std::pair<SettingTexts, std::string>> wrong{
        {{{"k", "18"}}, "choose 6"},
        {{{"precision", "double"}}, "choose float"},
        {{{"rounding", "published"}}, "choose safe"},
        {{{"output", "digest"}}, "choose pairs"},
        {{{"self", "on"}}, "choose off"},
        {{{"pair_layout", "items"}}, "choose slots"}};
    for (const auto& [given, remedy] : wrong) EXPECT_THAT(rejection(cuda, given, cubql), HasSubstr(remedy));
    cuda.id = "cuda:adopted";
    EXPECT_THAT(rejection(cuda, {}, cubql), HasSubstr("not on cuda:adopted"));
}

/// A baseline, and a device that it supports.
struct BaselineOnDevice {
    std::string algorithm, device;
};

/// Embree on the host, and cuBQL on every CUDA device.
std::vector<BaselineOnDevice> baselines_on_devices() {
    std::vector<BaselineOnDevice> all{{"embree", "host"}};
    for (const auto& name : device_names())
        if (name.starts_with("cuda:")) all.push_back({"cubql", name});
    return all;
}

class Baseline : public testing::TestWithParam<BaselineOnDevice> {
protected:
    void SetUp() override {
        if (const auto why = rejection(on_.info(), {}, baseline());
            why.find("built without") != std::string::npos)
            GTEST_SKIP() << why;
        if (sanitized()) GTEST_SKIP() << "a sanitized build has no kernels of k = 6";
    }
    void TearDown() override { on_.set_memory_limit(Device::no_memory_limit); }

    const Traversal& baseline() const { return algorithm(GetParam().algorithm); }
    bool accepts(const SettingTexts& given) const {
        return rejection(on_.info(), given, baseline()) == "no error";
    }

    std::unique_ptr<Session> session(const Traversal& traversal, const Scene& scene, SettingTexts given) {
        given["k"] = "6";
        for (const std::string capacity : {"pair_capacity", "contact_capacity"})
            given.emplace(capacity, "65536"); // clearing larger buffers would take most of the time
        return prepare_on(on_, traversal, scene, of_first_preset(traversal, given));
    }

    /// Compares pairs, digest and contacts of every frame for the same body pairs; returns the number of
    /// pairs.
    std::uint64_t expect_same(const Scene& scene, std::span<const Frame> frames, const SettingTexts& given) {
        const auto own = session(algorithm("chunked"), scene, given);
        const auto other = session(baseline(), scene, given);
        std::uint64_t pairs = 0;
        for (const auto& frame : frames) {
            const auto expected = own->run(frame);
            const auto result = other->run(frame);
            EXPECT_EQ(result.count, expected.count);
            EXPECT_EQ(result.body_pairs, expected.body_pairs);
            expect_same_digests(result, expected);
            if (result.digest() != expected.digest()) {
                EXPECT_EQ(result.download(), expected.download());
            }
            pairs += result.count;
        }
        return pairs;
    }

    std::uint64_t expect_same(const Scene& scene, const SettingTexts& given) {
        std::vector<Frame> frames;
        for (std::size_t i = 0; i < std::min<std::size_t>(scene.frame_count, 3); ++i)
            frames.push_back(scene.frame(i));
        return expect_same(scene, frames, given);
    }

    std::unique_ptr<Device> own_ = host::make_device();
    Device& on_ = GetParam().device == "host" ? *own_ : device(GetParam().device);
};

TEST_P(Baseline, FindsTheSamePairsWithEverySetting) {
    const auto of = [](const std::string& name, const std::vector<std::string>& values) {
        Axis axis;
        for (const auto& value : values) axis.push_back({{name, value}});
        return axis;
    };
    auto rounding = of("rounding", {"safe", "nearest", "published"});
    rounding.push_back({{"rounding", "safe"}, {"placement", "exact"}});
    for (const auto& given :
         pairwise({rounding, of("broad", {"sphere", "tight", "device"}), of("threads", {"1", "2", "5"}),
                   of("self", {"off", "on", "deformable"}), of("pair_layout", {"slots", "items"}),
                   of("builder", {"morton", "sah", "breadth", "hilbert", "median", "balanced"})})) {
        SCOPED_TRACE(text(given));
        if (!accepts(given)) continue;
        EXPECT_GT(expect_same(crowd(17, 12, 0.9), given), 1000u);
    }
}

TEST_P(Baseline, FindsTheSamePairsInScenes) {
    for (const std::string name : {"pile:bodies=12,frames=2,mesh=jack,density=0.2", "pile:bodies=9,frames=2"})
        EXPECT_GT(expect_same(make_scene(name), {{"contact_rule", "none"}}), 1000u) << name;
    const auto plates = make_scene("plates");
    const std::array frames{plates.frame(60), plates.frame(0), plates.frame(61)};
    EXPECT_GT(expect_same(plates, frames, {{"contact_rule", "none"}}), 100000u);
}

TEST_P(Baseline, FindsTheSamePairsInHardCases) {
    std::uint64_t pairs = 0;
    for (const auto& family : hard_families()) {
        if (family.name == "not-finite") continue;
        SCOPED_TRACE(family.name);
        for (const std::string rounding : {"safe", "published"})
            if (accepts({{"rounding", rounding}}))
                pairs += expect_same(make_scene(fmt::format("hard:{}", family.name)),
                                     {{"contact_rule", "none"}, {"rounding", rounding}});
    }
    EXPECT_GT(pairs, 1000u);
}

/// The limits of Embree's own arithmetic: numbers that it treats as zero, and boxes that it ignores.
TEST_P(Baseline, FindsTheSamePairsOfExtremeSizes) {
    for (const double size : {1e-44, 1e-41, 1e-38, 1e-20, 1e17, 1e18, 2e18, 1e19, 1e30, 1e35}) {
        std::vector<Eigen::Vector3d> positions;
        for (int x = -4; x < 4; ++x)
            for (int y = -4; y < 4; ++y) positions.emplace_back(x * size, y * size, size);
        Scene scene;
        scene.name = scene.key = "sizes";
        scene.meshes = {tetrahedra_at(positions, size), tetrahedra_at({positions.front()}, size)};
        scene.bodies = {{.mesh = 0}, {.mesh = 0}, {.mesh = 1}};
        Frame frame;
        frame.poses.resize(3);
        frame.deformed.resize(3);
        for (const double shift : {-1.0, 0.0, 1.0, 2.0, 8.0}) {
            frame.poses[1].translation = {shift * size, 0, size};
            frame.poses[2].translation = {shift * size, size, size};
            for (const std::string threads : {"1", "3"})
                EXPECT_GT(
                    expect_same(scene, std::array{frame}, {{"contact_rule", "none"}, {"threads", threads}}),
                    0u)
                    << size << " " << shift;
        }
    }
}

/// The set of skipped tetrahedra changes between frames and includes a whole body; trees are rebuilt and then
/// refitted.
TEST_P(Baseline, IgnoresSkippedTetrahedra) {
    const auto scene = boxes_scene(4, 4);
    const auto every = [&](std::uint32_t n, std::uint32_t first) {
        std::vector<std::uint32_t> list;
        for (auto t = first; t < scene.meshes[0].tetrahedra.size(); t += n) list.push_back(t);
        return list;
    };
    const std::vector<std::vector<std::vector<std::uint32_t>>> skipped{
        {},
        {every(7, 0), every(3, 0), every(2, 0)},
        {every(7, 0), every(3, 0), every(2, 0)},
        {{}, every(5, 3), every(1, 0)},
        {{}, every(1, 0), {}},
        {}};
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < skipped.size(); ++i) {
        frames.push_back(scene.frame(i % scene.frame_count));
        frames.back().skipped = skipped[i];
    }
    for (const std::string broad : {"tight", "device"})
        EXPECT_GT(expect_same(scene, frames, {{"contact_rule", "none"}, {"broad", broad}}), 1000u);
}

TEST_P(Baseline, GrowsBuffersAndSumsDigests) {
    const auto scene = crowd(31, 12, 0.9);
    const auto frame = scene.frame(0);
    const auto expected = session(algorithm("chunked"), scene, {})->run(frame).digest();
    const auto grown = session(
        baseline(), scene, {{"pair_capacity", "1"}, {"contact_capacity", "1"}, {"body_pair_capacity", "1"}});
    const auto result = grown->run(frame);
    EXPECT_GT(result.retries, 0u);
    EXPECT_EQ(result.digest(), expected);
    if (accepts({{"output", "digest"}})) {
        EXPECT_EQ(session(baseline(), scene, {{"output", "count"}})->run(frame).count, expected.count);
        EXPECT_EQ(session(baseline(), scene, {{"output", "digest"}})->run(frame).digest(), expected);
    }
    grown->count_work(true);
    EXPECT_GE(grown->run(frame).work.at("leaf_tests"), expected.count);
}

/// One body pair whose pairs do not fit is traversed in windows of items.
TEST_P(Baseline, SplitsABodyPairByItems) {
    auto scene = boxes_scene(6, 2);
    const auto frame = scene.frame(0);
    const BodyPair only{0, 1};
    const auto expected = session(algorithm("chunked"), scene, {})->run(frame, {&only, 1}).digest();
    const SettingTexts small{{"contact_rule", "none"}, {"pair_capacity", "1"}, {"body_pair_capacity", "1"}};
    std::size_t least = 0;
    {
        const auto alone = session(baseline(), scene, small);
        least = on_.bytes_allocated();
    }
    on_.set_memory_limit(least + 4 * expected.count); // half of the bytes for the pairs
    const auto result = session(baseline(), scene, small)->run(frame, {&only, 1});
    EXPECT_GT(result.batches, 1u);
    EXPECT_EQ(result.digest(), expected);
}

/// The trace lists the library's work as launches, under the stages of the project's own algorithms.
TEST_P(Baseline, IsTracedAsRefitAndTraversal) {
    const auto scene = crowd(41, 12, 0.9);
    const auto traced = session(baseline(), scene, {{"contact_rule", "none"}});
    on_.set_clocks(Clocks::on);
    traced->run(scene.frame(0));
    std::map<std::string, Stage> stages;
    for (const auto& event : on_.finish().events)
        if (event.command == Command::launch && event.device_ns > 0) stages[event.label] = event.stage;
    on_.set_clocks(Clocks::off);
    EXPECT_EQ(stages.at("refit_" + GetParam().algorithm), Stage::refit);
    EXPECT_EQ(stages.at("collide_" + GetParam().algorithm), Stage::traverse);
}

INSTANTIATE_TEST_SUITE_P(Baselines, Baseline, testing::ValuesIn(baselines_on_devices()), [](const auto& one) {
    return one.param.algorithm + device_label(one.param.device);
});

} // namespace
} // namespace tandem
