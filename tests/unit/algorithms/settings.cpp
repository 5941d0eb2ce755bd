// SPDX-License-Identifier: MIT
#include "algorithms/gproximity/gproximity_settings.h"
#include "algorithms/bounds/geometry.h"
#include "algorithms/traversal.h"
#include "base/error.h"
#include "tests/support/cells.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using testing::HasSubstr;

Settings with(const SettingTexts& given) { return resolved(algorithm("chunked"), given); }

TEST(Settings, DefaultsAreThoseOfTheDesign) {
    const auto settings = with({});
    EXPECT_EQ(settings.text("k"), "18");
    EXPECT_EQ(settings.text("rounding"), "safe");
    EXPECT_EQ(settings.text("precision"), "float");
    EXPECT_EQ(settings.text("seed_threshold"), "0");
    EXPECT_EQ(settings.text("residency"), "resident");
}

TEST(Settings, IntegersMayBeWrittenWithAnExponent) {
    EXPECT_EQ(with({{"seed_threshold", "1e7"}}).text("seed_threshold"), "10000000");
    EXPECT_THAT(message_of([] { with({{"seed_threshold", "1.5"}}); }), HasSubstr("impossible"));
}

TEST(Settings, UnknownNamesSuggestTheNearest) {
    EXPECT_THAT(message_of([] { with({{"rouding", "safe"}}); }), HasSubstr("the nearest is 'rounding'"));
    EXPECT_THAT(message_of([] {
                    with({{"k", "10"}});
                }),
                HasSubstr("choose one of 6, 8, 12, 14, 16, 18, 20, 24, 26"));
    EXPECT_THAT(message_of([] { with({{"group_size", "-1"}}); }), HasSubstr("from 0 to 1024"));
    EXPECT_THAT(message_of([] { algorithm("chunky"); }), HasSubstr("the nearest is 'chunked'"));
    EXPECT_THAT(message_of([] { preset(algorithm("gproximity"), "fare"); }),
                HasSubstr("the nearest is 'fair'"));
    EXPECT_THAT(message_of([] {
                    geometry_of(with({{"k", "18"}, {"axes", "coordinate"}}));
                }),
                HasSubstr("goes with k=8"));
    for (const std::string rounding : {"nearest", "published"})
        EXPECT_THAT(message_of([&] {
                        geometry_of(with({{"placement", "exact"}, {"rounding", rounding}}));
                    }),
                    HasSubstr("goes with rounding=safe or directed"));
}

TEST(Settings, DecisionsWithCertaintyNeedDouble) {
    DeviceInfo info;
    info.id = "opencl:9";
    info.max_group_size = 256;
    info.local_bytes = 32768;
    info.has_double = false;
    for (const std::string decision : {"recheck", "fp64", "exact"})
        EXPECT_EQ(message_of([&] {
                      algorithm("chunked").fitted(with({{"decision", decision}}), info);
                  }),
                  "setting decision=" + decision
                      + " is impossible on opencl:9, which has no double; choose fp32");
    EXPECT_EQ(algorithm("chunked").fitted(with({}), info)[parameters::decision], DecisionPrecision::fp32);
    EXPECT_EQ(algorithm("chunked").fitted(with({{"decision", "none"}}), info)[parameters::decision],
              DecisionPrecision::none);
    EXPECT_THAT(message_of([] {
                    with({{"decision", "fp16"}});
                }),
                HasSubstr("choose one of fp32, recheck, fp64, exact, none"));
    EXPECT_THAT(message_of([] {
                    with({{"contact_rule", "clop"}});
                }),
                HasSubstr("choose one of opposing, published, sat, clip, "));
}

/// A GPU with the memory of a K40c.
DeviceInfo gpu_of(std::uint32_t units, std::uint32_t most_group, std::uint64_t local_bytes) {
    DeviceInfo info;
    info.id = "cuda:9";
    info.is_gpu = info.has_double = true;
    info.compute_units = units;
    info.max_group_size = most_group;
    info.local_bytes = local_bytes;
    info.global_bytes = 12079595520;
    info.max_allocation = info.global_bytes / 2;
    return info;
}

std::pair<Settings, QueueSizes> sizes_on(const DeviceInfo& info, const std::string& name,
                                         const SettingTexts& given = {}) {
    const auto& gproximity = algorithm("gproximity");
    const auto asked =
        resolve(gproximity.parameters(), preset(gproximity, name).values, given, gproximity.name());
    const auto settings = gproximity.fitted(asked, info);
    return {settings, queue_sizes(settings, info)};
}

/// Sizes that the paper's release has on a device, against those of the paper's GPUs: the release takes 2048
/// work-items a unit and a quarter of the local memory for a group.
TEST(Settings, ReleasedSizesFollowTheDevice) {
    struct Known {
        DeviceInfo info;
        std::uint32_t groups, group_size, local_queue, idle;
    };
    for (const auto& known : {Known{gpu_of(15, 1024, 49152), 30, 992, 1023, 664},      // K40c
                              Known{gpu_of(13, 1024, 49152), 26, 992, 1023, 664},      // K20c
                              Known{gpu_of(40, 256, 32768), 320, 256, 682, 171},       // FirePro W8100
                              Known{gpu_of(132, 1024, 49152), 272, 992, 1023, 664}}) { // H100, H200
        const auto [settings, sizes] = sizes_on(known.info, "published");
        EXPECT_EQ(settings[parameters::group_size], known.group_size);
        EXPECT_EQ(sizes.groups, known.groups);
        EXPECT_EQ(sizes.batch, known.groups);
        EXPECT_EQ(sizes.local_queue, known.local_queue);
        EXPECT_EQ(sizes.initial_items, known.local_queue);
        EXPECT_EQ(sizes.idle_limit, known.idle);
        EXPECT_EQ(sizes.queue_capacity, 3019898880u / 12 / known.groups); // a quarter of the memory
        EXPECT_EQ(settings.text("queue_bytes"), "device");
        EXPECT_EQ(sizes_on(known.info, "published", {{"groups", "7"}}).second.groups, 7u);
    }
    // Groups of one work-item, as on device host, have the other sizes of a GPU's groups.
    EXPECT_EQ(sizes_on(gpu_of(2, 1, 1 << 20), "published").second.groups, 4u);
}

TEST(Settings, ReleasedSizesEqualThePresetOfTheGpu) {
    const auto k40c = gpu_of(15, 1024, 49152);
    const auto derived = sizes_on(k40c, "published").second, named = sizes_on(k40c, "published-k40c").second;
    EXPECT_EQ(derived.groups, named.groups);
    EXPECT_EQ(derived.queue_capacity, named.queue_capacity);
    EXPECT_EQ(derived.initial_items, named.initial_items);
    EXPECT_EQ(derived.idle_limit, named.idle_limit);
    EXPECT_THAT(
        message_of([&] {
            sizes_on(k40c, "published", {{"queue_bytes", "all"}});
        }),
        HasSubstr("queue_bytes=all is impossible; give an integer from 12 to 1099511627776, or device"));
}

/// A launch of the release ends where a queue has no room for a round of 2 x 992 items and the local queue of
/// 1023 on a K40c with its 30 queues.
TEST(Settings, QueuesAreLargerThanWhatEndsALaunch) {
    const auto k40c = gpu_of(15, 1024, 49152);
    const auto with = [&](const std::string& preset, std::uint64_t bytes) {
        return sizes_on(k40c, preset, {{"queue_bytes", std::to_string(bytes)}}).second.queue_capacity;
    };
    constexpr std::uint64_t least = 30 * 12 * 3008;
    EXPECT_EQ(with("published", least), 3008u);
    EXPECT_EQ(with("published-k40c", least), 3008u);
    EXPECT_THAT(message_of([&] { with("published", least - 1); }),
                HasSubstr("makes 30 queues of 3007 items"));
    EXPECT_THAT(message_of([&] { with("published", least - 1); }),
                HasSubstr("give at least --set queue_bytes=1082880, or set queue_capacity"));
    EXPECT_LT(with("fair", 12000), 100u) << "its launches do not end with the queue";
    EXPECT_EQ(sizes_on(k40c, "published", {{"queue_capacity", "16"}}).second.queue_capacity, 16u);
}

/// Values that tiled derives from device and scene; on a GPU, more than six directions depend on both.
TEST(Settings, TiledFitsDeviceAndScene) {
    const auto& tiled = algorithm("tiled");
    DeviceInfo gpu;
    gpu.id = "cuda:9";
    gpu.max_group_size = 1024;
    gpu.local_bytes = 49152;
    gpu.has_double = gpu.is_gpu = true;
    gpu.global_bytes = 4u * (18 * 4) * (1u << 21); // bounds of 2^21 tetrahedra take a quarter
    auto processor = gpu;
    processor.is_gpu = false;
    const auto scene_of = [](std::size_t tetrahedra) {
        Scene scene;
        scene.meshes.resize(1);
        scene.meshes[0].tetrahedra.resize(tetrahedra / 4);
        scene.bodies.assign(4, {.mesh = 0});
        return scene;
    };
    const auto small = scene_of(1u << 21), large = scene_of((1u << 21) + 4);
    const auto fitted = [&](const DeviceInfo& info, const Scene* scene, const SettingTexts& given) {
        return tiled.fitted(resolved(tiled, given), info, scene);
    };
    const auto slabs = [&](const DeviceInfo& info, const Scene* scene, const SettingTexts& given) {
        return fitted(info, scene, given).text("slabs");
    };
    for (const auto& info : {gpu, processor}) {
        EXPECT_EQ(slabs(info, &small, {}), "touched");
        EXPECT_EQ(slabs(info, &large, {}), "three");
        EXPECT_EQ(slabs(info, nullptr, {}), "usual");
        EXPECT_EQ(slabs(info, &large, {{"k", "12"}}), "all");
        EXPECT_EQ(slabs(info, nullptr, {{"k", "12"}}), "all");
        EXPECT_EQ(slabs(info, &small, {{"slabs", "three"}}), "three");
        EXPECT_EQ(slabs(info, &large, {{"slabs", "all"}}), "all");
    }
    EXPECT_EQ(fitted(gpu, nullptr, {}).text("most_seeds"), "16384");
    EXPECT_EQ(fitted(processor, nullptr, {}).text("most_seeds"), "256");
    EXPECT_EQ(fitted(gpu, &small, {{"most_seeds", "7"}}).text("most_seeds"), "7");
    EXPECT_EQ(fitted(gpu, nullptr, {}).text("group_size"), "128");
    EXPECT_EQ(fitted(processor, nullptr, {}).text("group_size"), "1");
    EXPECT_EQ(fitted(processor, nullptr, {{"group_size", "64"}}).text("group_size"), "64");
}

/// Group sizes that nobody asked for.
TEST(Settings, GroupSizesFitTheDevice) {
    DeviceInfo info;
    info.id = "opencl:9";
    info.local_bytes = 49152;
    info.has_double = true;
    const auto fitted = [&](std::uint32_t largest) {
        info.max_group_size = largest;
        return algorithm("chunked").fitted(with({}), info).text("group_size");
    };
    EXPECT_EQ(fitted(1024), "128");
    EXPECT_EQ(fitted(64), "64");
    EXPECT_EQ(fitted(1), "1");
}

/// 48 KiB, the limit of a CUDA kernel: the error comes before the compiler's.
TEST(Settings, StacksMustFitLocalMemory) {
    DeviceInfo info;
    info.id = "cuda:9";
    info.max_group_size = 1024;
    info.local_bytes = 49152;
    const auto check = [&](const SettingTexts& given) {
        return message_of([&] { algorithm("chunked").fitted(with(given), info); });
    };
    EXPECT_EQ(check({{"group_size", "256"}}), "no error");
    EXPECT_THAT(
        check({{"group_size", "512"}}),
        HasSubstr("group_size=512 needs 82140 bytes of local memory with schedule=group and cuda:9 has "
                  "49152"));
    EXPECT_EQ(check({{"group_size", "512"}, {"schedule", "item"}}), "no error");
    EXPECT_THAT(check({{"group_size", "1024"}, {"schedule", "item"}, {"leaves", "16384"}}),
                HasSubstr("needs 176128 bytes"));
}

TEST(Settings, EveryPresetResolves) {
    std::size_t presets = 0;
    for (const auto* traversal : algorithms()) {
        for (const auto& p : traversal->presets()) {
            const auto settings = resolve(traversal->parameters(), p.values, {}, traversal->name());
            EXPECT_EQ(settings.texts().size(), traversal->parameters().size());
            ++presets;
        }
    }
    EXPECT_GE(presets, 9u);
}

TEST(Geometry, DirectionsAreHalfOfK) {
    for (const int k : {6, 8, 12, 14, 16, 18, 20, 24, 26}) {
        const auto all = directions({.k = k});
        EXPECT_EQ(all.size(), static_cast<std::size_t>(k) / 2);
        std::set<std::array<int, 3>> lines; // a direction and its opposite are one slab
        for (const auto& d : all) lines.insert(std::max(d, {-d[0], -d[1], -d[2]}));
        EXPECT_EQ(lines.size(), all.size()) << k;
    }
    // Directions in the symmetric sets of 18 and 26 planes that FCL's sets of 16 and 24 lack.
    const auto has = [](int k, const std::array<int, 3>& d) {
        const auto all = directions({.k = k});
        return std::find(all.begin(), all.end(), d) != all.end();
    };
    EXPECT_TRUE(has(18, {0, 1, -1}) && !has(16, {0, 1, -1}));
    EXPECT_TRUE(has(26, {1, 1, 1}) && !has(24, {1, 1, 1}));
    EXPECT_TRUE(has(20, {1, 1, 1}) && !has(20, {1, 0, 0}) && !has(12, {1, 0, 0}));
    EXPECT_EQ(directions({.k = 8})[1], (std::array<int, 3>{1, 1, -1}));
    EXPECT_EQ(directions({.k = 8, .coordinate_axes = true})[1], (std::array<int, 3>{0, 1, 0}));
}

} // namespace
} // namespace tandem
