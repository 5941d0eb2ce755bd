// SPDX-License-Identifier: MIT
// The host device at every instruction level and with any number of threads: equal bits.
#include "algorithms/parameters/table.h"
#include "algorithms/traversal.h"
#include "backends/host/host_device.h"
#include "tests/support/flawed.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tandem {
namespace {

struct Answer {
    Digest pairs, contacts;

    bool operator==(const Answer&) const = default;
};

Answer answer_of(Device& on, const std::string& algorithm_name, const SettingTexts& given) {
    const auto scene = support::boxes_scene(5, 4);
    const auto& traversal = algorithm(algorithm_name);
    const std::array devices{&on};
    const auto settings =
        resolve(traversal.parameters(), traversal.presets().front().values, given, traversal.name());
    const auto session = traversal.prepare(devices, scene, settings);
    const auto result = session->run(scene.frame(2));
    EXPECT_GT(result.count, 1000u);
    return {result.digest(), result.contact_digest()};
}

/// The level in the device's own description, or 0.
int highest_level() {
    const auto text = host::make_device()->info().compiler;
    const auto at = text.find("x86-64-v");
    return at == std::string::npos ? 0 : text[at + 8] - '0';
}

TEST(DeviceLevels, HaveEqualBits) {
    const auto highest = host::make_device();
    for (const std::string k : {"8", "18"})
        for (const std::string precision : {"float", "double"})
            for (const std::string rounding : {"safe", "published"}) {
                const SettingTexts given{{"k", k}, {"precision", precision}, {"rounding", rounding}};
                const auto expected = answer_of(*highest, "tiled", given);
                for (const int level : host::compiled_levels()) {
                    if (level > highest_level()) continue;
                    const auto device = host::make_device(level);
                    EXPECT_EQ(answer_of(*device, "tiled", given), expected) << level << k << precision;
                }
            }
}

TEST(DeviceLevels, AreReported) {
    for (const int level : host::compiled_levels()) {
        if (level > highest_level()) continue;
        EXPECT_THAT(host::make_device(level)->info().compiler,
                    testing::HasSubstr(fmt::format("x86-64-v{}", level)));
    }
    EXPECT_THAT(host::make_device()->info().compiler, testing::StartsWith("g++ "));
}

/// A level between two compiled ones falls back to the lower one.
TEST(DeviceLevels, BelowTheLowestCompiledThereIsNoDevice) {
    const auto levels = host::compiled_levels();
    if (levels.empty()) {
        EXPECT_THAT(host::make_device(0)->info().compiler, testing::Not(testing::HasSubstr("x86-64")));
        return;
    }
    const auto text = [](int level) {
        try {
            return host::make_device(level)->info().compiler;
        } catch (const DeviceError& error) {
            return std::string(error.what());
        }
    };
    EXPECT_THAT(text(*levels.begin() - 1), testing::HasSubstr("TANDEM_LEVELS"));
    EXPECT_THAT(text(9), testing::HasSubstr(fmt::format("x86-64-v{}", highest_level())));
}

TEST(DeviceLevels, AnyNumberOfThreadsGivesTheSame) {
    const auto device = host::make_device();
    for (const std::string name : {"tiled", "chunked", "gproximity"}) {
        const auto expected = answer_of(*device, name, {{"threads", "1"}});
        for (const std::string threads : {"2", "3", "7", "0"})
            EXPECT_EQ(answer_of(*device, name, {{"threads", threads}}), expected) << name << threads;
    }
}

/// More threads than cores are accepted without a message.
TEST(DeviceLevels, ManyThreadsGiveNoMessage) {
    testing::internal::CaptureStderr();
    const auto device = host::make_device();
    answer_of(*device, "tiled", {{"threads", "64"}});
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

} // namespace
} // namespace tandem
