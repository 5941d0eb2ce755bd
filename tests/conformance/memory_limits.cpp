// SPDX-License-Identifier: MIT
// Frames under every kind of memory limit: the answer is that of an unlimited session, or OutOfMemory. No
// kernel writes past the end of a buffer (guards of support/cells.h, or the address sanitizer).
#include "tests/support/limited.h"
#include "tests/support/long_form.h"
#include "tests/support/sanitized.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

/// Parameters: device, algorithm, precision.
class MemoryLimits : public testing::TestWithParam<std::tuple<std::string, std::string, std::string>> {
protected:
    MemoryLimits() {
        for (std::size_t i = 0; i < scene.frame_count; ++i) frames.push_back(scene.frame(i));
    }

    /// Frames of one cell under `count` limits, from `least` to ten times that.
    void scan(const SettingTexts& given, int count) {
        SCOPED_TRACE(std::string(traversal.name()) + text(given));
        std::vector<Answer> right;
        {
            const auto session = prepare_on(on, traversal, scene, given);
            for (const auto& frame : frames) right.emplace_back(session->run(frame));
        }
        const auto least = static_cast<double>(least_bytes(on, traversal, scene, given));
        for (int i = 0; i < count; ++i) {
            const auto limit = static_cast<std::size_t>(least * std::pow(10.0, i / (count - 1.0)));
            SCOPED_TRACE(fmt::format("limit {}", limit));
            run_limited(given, limit, right);
        }
    }

    void run_limited(const SettingTexts& given, std::size_t limit, const std::vector<Answer>& right) {
        const Limited limited(on, limit);
        std::unique_ptr<Session> session;
        try {
            session = prepare_on(on, traversal, scene, given);
        } catch (const OutOfMemory&) {
            ++out_of_memory_;
            return;
        }
        for (std::size_t i = 0; i < frames.size(); ++i) {
            try {
                const auto result = session->run(frames[i]);
                EXPECT_EQ(Answer(result), right[i]) << "frame " << i;
                ++(result.batches > 1 ? in_batches_ : whole_);
            } catch (const OutOfMemory&) {
                ++out_of_memory_;
            }
        }
    }

    /// The limits are relevant only if every outcome occurs.
    void expect_all_outcomes() const {
        fmt::print("{} frames whole, {} in batches, {} out of memory\n", whole_, in_batches_, out_of_memory_);
        EXPECT_GT(whole_, 0);
        EXPECT_GT(in_batches_, 0);
        EXPECT_GT(out_of_memory_, 0);
    }

    Device& on = device(std::get<0>(GetParam()));
    const Traversal& traversal = algorithm(std::get<1>(GetParam()));
    const Scene scene = breathing(4);
    std::vector<Frame> frames;

private:
    int whole_ = 0, in_batches_ = 0, out_of_memory_ = 0;
};

/// All contact rules and layouts; decisions and data paths alternate.
TEST_P(MemoryLimits, KeepTheAnswerLong) {
    constexpr std::array decisions{"fp32", "recheck", "exact", "fp64"};
    constexpr std::array layouts{"slots", "items"};
    const auto& precision = std::get<2>(GetParam());
    const bool on_host = on.info().id == "host";
    const auto number = std::ranges::find(algorithms(), &traversal) - algorithms().begin();
    if (!on_host && !long_form() && (number % 2 == 0) != (precision == "float"))
        GTEST_SKIP() << "the short form has one precision of each algorithm where kernels must be compiled";
    // Sanitized kernels are many times slower and use the short form.
    const bool every_one = long_form() && !sanitized();
    const int limits = !every_one ? 6 : on_host ? 40 : 12;
    const auto paths = residencies_of(traversal);
    const std::size_t first = precision == "double" ? 1 : 0;
    std::size_t turn = 0;
    for (const auto& word : parameters::contact_rule.choices())
        for (std::size_t layout = 0; layout < layouts.size(); ++layout) {
            const auto rule = turn++ / layouts.size();
            // The short form runs every other rule with each precision and one layout. Where kernels must be
            // compiled, it runs one rule.
            const bool is_short = rule % 2 == first && layout == rule / 2 % 2 && (on_host || rule == first);
            if (!every_one && !is_short) continue;
            const bool is_resident = needs_pressures(static_cast<ContactRule>(word.value));
            SettingTexts given = is_resident ? paths.front() : paths[(turn + first) / 3 % paths.size()];
            given.merge(SettingTexts{{"k", "8"},
                                     {"contact_rule", std::string(word.text)},
                                     {"precision", precision},
                                     {"pair_layout", layouts[layout]},
                                     {"decision", decisions[(rule + first) % decisions.size()]}});
            // As on two compute units: with many, queues leave pairs too little of the limits to need
            // batches.
            if (declares(traversal, "groups")) given.merge(SettingTexts{{"groups", on_host ? "4096" : "32"}});
            scan(given, limits);
        }
    expect_all_outcomes();
}

std::vector<std::string> algorithm_names() {
    std::vector<std::string> names;
    for (const auto* traversal : algorithms()) names.emplace_back(traversal->name());
    return names;
}

std::string name_of(const testing::TestParamInfo<MemoryLimits::ParamType>& test) {
    const auto& [device_name, algorithm_name, precision] = test.param;
    return device_label(device_name) + "_" + algorithm_name + "_" + precision;
}

INSTANTIATE_TEST_SUITE_P(Devices, MemoryLimits,
                         testing::Combine(testing::ValuesIn(device_names()),
                                          testing::ValuesIn(algorithm_names()),
                                          testing::Values("float", "double")),
                         name_of);

struct Line {
    const char* algorithm;
    SettingTexts more;
    std::size_t limit;
};

/// Regression test: these runs corrupted the heap when contact ids and contact values were two buffers of
/// different capacities.
TEST(MemoryLimitsOnHost, RunsThatCorruptedTheHeapAreRight) {
    if (sanitized()) GTEST_SKIP() << "the limits are those of kernels that are not sanitized";
    const SettingTexts other{{"precision", "double"}, {"pair_layout", "items"}, {"k", "8"}};
    auto& on = device("host");
    const auto scene = make_scene("pile:bodies=4,frames=3");
    for (const auto& [algorithm_name, more, limit] :
         {Line{"tiled", {}, 2000000}, Line{"tiled", other, 3147038}, Line{"chunked", {}, 3147038},
          Line{"chunked", other, 3947643}, Line{"gproximity", {}, 4421360},
          Line{"gproximity", other, 6211691}}) {
        const auto& traversal = algorithm(algorithm_name);
        auto given = more;
        given["contact_rule"] = "sat";
        SCOPED_TRACE(algorithm_name + text(given));
        const auto unlimited = prepare_on(on, traversal, scene, given);
        std::vector<Answer> right;
        for (std::size_t i = 0; i < 3; ++i) right.emplace_back(unlimited->run(scene.frame(i)));
        const Limited limited(on, limit);
        const auto session = prepare_on(on, traversal, scene, given);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(Answer(session->run(scene.frame(i))), right[i]);
    }
}

} // namespace
} // namespace tandem
