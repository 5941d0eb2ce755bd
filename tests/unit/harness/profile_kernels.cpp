// SPDX-License-Identifier: MIT
// Kernel times against required work: ceilings, floors, and which of them bounds the time.
#include "harness/profile/output.h"
#include "base/error.h"
#include "tests/support/folder.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>

namespace tandem::profile {
namespace {

using Json = nlohmann::ordered_json;
using testing::Optional;

Json measured(double median) { return {{"median", median}, {"samples", {median}}}; }

Json ceilings(const std::string& id = "cuda:0", const std::string& hardware = "0123456789abcdef") {
    return {{"schema", 1},
            {"device", {{"id", id}, {"name", "GPU"}, {"hardware", hardware}, {"kind", "gpu"}}},
            {"copy_bytes_per_s", measured(3e12)},
            {"read_bytes_per_s", measured(4e12)},
            {"cache_read_bytes_per_s", measured(8e12)},
            {"launch_queued_s", measured(2e-6)},
            {"launch_timed_s", measured(1e-6)},
            {"overlap_tests_k8_per_s", measured(3e12)},
            {"overlap_tests_k18_per_s", measured(1e12)}};
}

TEST(ProfileLimits, AreTheBestOfCeilings) {
    const auto limits = limits_of(ceilings(), 8);
    EXPECT_EQ(limits.bytes_per_s, 4e12);
    EXPECT_EQ(limits.cached_bytes_per_s, 8e12);
    EXPECT_EQ(limits.cached_bytes, 16 << 20);
    EXPECT_EQ(limits.launch_s, 1e-6);
    EXPECT_EQ(limits.operations_per_s, 24e12);
    EXPECT_EQ(limits_of(ceilings(), 6).operations_per_s, 24e12);
    EXPECT_EQ(limits_of(ceilings(), 18).operations_per_s, 18e12);
    EXPECT_EQ(limits_of(ceilings(), 26).operations_per_s, 18e12);
    EXPECT_EQ(limits_of(ceilings(), 14).operations_per_s, 24e12 - 0.6 * 6e12);
    auto old = ceilings();
    old.erase("launch_timed_s");
    EXPECT_EQ(limits_of(old, 8).launch_s, 2e-6);
}

/// A replay of two frames, one round each; kernel `k` takes the given nanoseconds per launch.
Measurement replays_of(std::initializer_list<std::int64_t> sums, std::uint64_t launches = 2) {
    Measurement m;
    for (const auto sum : sums) {
        auto& replay = m.breakdowns.emplace_back();
        replay.frame_ns = {1, 1};
        replay.kernels["k"] = {sum, launches};
        replay.kernels["other"] = {sum, 2};
    }
    return m;
}

KernelCost cost(std::optional<double> bytes, std::optional<double> operations) {
    KernelCost c{"k", {}, {}, "by hand"};
    if (bytes) c.bytes = [=](const FrameFacts&) { return *bytes; };
    if (operations) c.operations = [=](const FrameFacts&) { return *operations; };
    return c;
}

KernelProfile profiled(const KernelCost& cost, std::int64_t ns, std::uint64_t launches = 2) {
    FrameFacts facts;
    facts.work = {{"something", 1}};
    const auto kernels = profile_kernels(replays_of({2 * ns}, launches), facts, std::span(&cost, 1),
                                         limits_of(ceilings(), 18));
    return *std::ranges::find(kernels, "k", &KernelProfile::entry);
}

TEST(ProfileKernels, AreAveragesPerFrame) {
    const auto kernels = profile_kernels(replays_of({2000, 6000, 4000}), {}, {}, limits_of(ceilings(), 18));
    ASSERT_EQ(kernels.size(), 2u);
    EXPECT_EQ(kernels[0].ns.median, 2000);
    EXPECT_EQ(kernels[0].ns.low, 1000);
    EXPECT_EQ(kernels[0].ns.high, 3000);
    EXPECT_EQ(kernels[0].launches, 1);
    EXPECT_EQ(kernels[0].time_fraction, 0.5);
    EXPECT_FALSE(kernels[0].bytes);
    EXPECT_TRUE(kernels[0].how.empty());
}

TEST(ProfileKernels, AreBoundByTheLargestTermOfTheirFloor) {
    // 40 MB at 4 TB/s take 10 us, beyond the cache; 8 MB at 8 TB/s take 1 us; 180 M at 18 T/s take 10 us.
    auto kernel = profiled(cost(40e6, 18e6), 20'000);
    EXPECT_THAT(kernel.floor.bytes, Optional(10'000));
    EXPECT_THAT(kernel.floor.operations, Optional(1'000));
    EXPECT_THAT(kernel.over_floor(), Optional(2.0));
    EXPECT_THAT(kernel.bound(), Optional(std::string_view("memory")));
    EXPECT_THAT(kernel.bytes_per_s(), Optional(2e12));
    EXPECT_THAT(kernel.of_bytes(), Optional(0.5));
    EXPECT_THAT(profiled(cost(8e6, 0), 1'500, 0).bound(), Optional(std::string_view("cache")));
    kernel = profiled(cost(8e6, 180e6), 20'000);
    EXPECT_TRUE(kernel.floor.cached);
    EXPECT_THAT(kernel.bound(), Optional(std::string_view("operations")));
    EXPECT_THAT(kernel.of_operations(), Optional(0.5));
    // Ten launches of 1 us.
    EXPECT_THAT(profiled(cost(8e6, 18e6), 20'000, 20).bound(), Optional(std::string_view("launches")));
}

TEST(ProfileKernels, AreBoundByLatencyWhereEverythingIsDeclared) {
    EXPECT_THAT(profiled(cost(40e6, 18e6), 29'999).bound(), Optional(std::string_view("memory")));
    EXPECT_THAT(profiled(cost(40e6, 18e6), 30'000).bound(), Optional(std::string_view("latency")));
    EXPECT_EQ(profiled(cost(40e6, {}), 30'000).bound(), std::nullopt);
    EXPECT_EQ(profiled(cost({}, 18e6), 30'000).bound(), std::nullopt);
    EXPECT_EQ(profiled(cost({}, {}), 30'000).bound(), std::nullopt);
    EXPECT_THAT(profiled(cost(40e6, {}), 20'000).bound(), Optional(std::string_view("memory")));
    EXPECT_THAT(profiled(cost({}, {}), 2'000).bound(), Optional(std::string_view("launches")));
}

TEST(ProfileKernels, UncountedWorkIsUnknown) {
    const auto declared = cost(1e6, 1e6);
    const auto kernels = profile_kernels(replays_of({1000}), {}, std::span(&declared, 1), {});
    EXPECT_FALSE(kernels.front().operations);
    EXPECT_TRUE(kernels.front().bytes);
    EXPECT_FALSE(kernels.front().floor.ns());
    EXPECT_FALSE(kernels.front().bound());
}

class ProfileCeilings : public support::FolderTest {};

TEST_F(ProfileCeilings, MatchTheDevice) {
    const auto path = this->path("ceilings.jsonl");
    auto last = ceilings();
    last["read_bytes_per_s"] = measured(5e12);
    // The hardware digest in the device's description.
    DeviceInfo info;
    info.id = "cuda:1";
    info.name = "GPU";
    std::ofstream(path) << ceilings("opencl:0").dump() << "\n"
                        << ceilings().dump() << "\n"
                        << last.dump() << "\n";
    // matched by name: the file has no hardware digest
    EXPECT_EQ(limits_of(read_ceilings(path, info), 18).bytes_per_s, 5e12);
    info.hardware = "another";
    EXPECT_THROW(read_ceilings(path, info), InputError);
    std::ofstream(path) << "{\"key\": 1}\nno JSON\n";
    EXPECT_THROW(read_ceilings(path, info), InputError);
    EXPECT_THROW(read_ceilings(path + ".none", info), InputError);
}

TEST(ProfileTable, SumsShortKernels) {
    Profile profile;
    profile.ceilings_from = "measured";
    Measurement m = replays_of({1'000'000});
    m.breakdowns.back().kernels["short"] = {900, 2};
    m.breakdowns.back().kernels["shorter"] = {800, 2};
    profile.kernels = profile_kernels(m, {}, {}, limits_of(ceilings(), 18));
    const auto text = profile_table(profile, false);
    EXPECT_THAT(text, testing::HasSubstr("2 below 1 %"));
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("shorter")));
    EXPECT_THAT(profile_table(profile, true), testing::HasSubstr("shorter"));
}

} // namespace
} // namespace tandem::profile
