// SPDX-License-Identifier: MIT
// Every algorithm and preset against brute force, on the host and on OpenCL, over a pairwise covering array
// of settings and group sizes. The tests iterate the list of algorithms, so they cover new entries
// automatically.
#include "tests/support/contact_rules.h"
#include "tests/support/on_device.h"
#include "tests/support/long_form.h"
#include "tests/support/sanitized.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"
#include "base/error.h"

namespace tandem {
namespace {

using namespace support;

using SettingValues = std::pair<std::string, std::vector<std::string>>;

const std::vector<SettingValues> shared_settings{{"residency", {"resident", "published"}},
                                                 {"convert", {"serial", "parallel"}},
                                                 {"copies", {"none", "pair"}},
                                                 {"work_items", {"64", "2048"}},
                                                 {"broad", {"sphere", "device"}},
                                                 {"self", {"off", "on", "deformable"}},
                                                 {"body_pair_capacity", {"1", "65536"}},
                                                 {"order", {"any", "canonical"}},
                                                 {"motion", {"none", "linear"}},
                                                 {"margin", {"0", "0.01"}}, //
                                                 {"pair_capacity", {"1", "100000"}},
                                                 {"contact_capacity", {"1", "100000"}}};

const std::vector<SettingValues> settings_of_single_algorithms{
    {"leaves", {"2", "4", "32"}},
    {"seed_threshold", {"0", "1", "40", "1e7"}},
    {"seed_target", {"1000", "1048576"}},
    {"seed_capacity", {"1", "65536"}},
    {"tree", {"body", "scene"}},
    {"rebuild", {"1", "2"}},
    {"builder", {"morton", "sah", "breadth", "hilbert", "median", "balanced"}},
    {"output", {"pairs", "contacts"}},
    {"slabs", {"three", "all", "touched"}},
    {"tile_pair_capacity", {"1", "65536"}},
    {"most_seeds", {"1", "256", "16384"}},
    {"root_test", {"yes", "no"}},
    {"schedule", {"group", "item"}},
    {"descent", {"both", "larger", "unlike"}},
    {"groups", {"8", "13"}},
    {"local_queue", {"4", "200"}},
    {"initial_items", {"1", "0"}},
    {"queue_capacity", {"4", "1000"}},
    {"idle_limit", {"1", "1000"}},
    {"batch", {"0", "5"}},
    {"upload", {"seeds", "queues"}},
    {"pair_layout", {"slots", "items"}},
    {"refill", {"yes", "no"}},
    {"full_exit", {"yes", "no"}},
    {"balance", {"parallel", "serial"}},
    {"balance_group_size", {"1", "32"}}};

Axis axis_of(const SettingValues& setting) {
    Axis axis;
    for (const auto& value : setting.second) axis.push_back({{setting.first, value}});
    return axis;
}

/// Every k, and both choices of axes where there are two.
Axis axis_of_directions() {
    const std::vector<std::string> every{"6", "8", "12", "14", "16", "18", "20", "24", "26"};
    Axis axis;
    for (const auto& k : sanitized() ? std::vector<std::string>{"8", "18"} : every) {
        axis.push_back({{"k", k}});
        if (k == "8" && !sanitized()) axis.push_back({{"k", k}, {"axes", "coordinate"}});
    }
    return axis;
}

/// Whether no other algorithm declares the setting.
bool is_own(const Traversal& traversal, const Parameter& parameter) {
    return std::ranges::none_of(algorithms(), [&](const Traversal* other) {
        return other != &traversal && declares(*other, std::string(parameter.name));
    });
}

bool is_listed(std::string_view name) {
    const auto has_name = [name](const SettingValues& setting) { return setting.first == name; };
    return std::ranges::any_of(shared_settings, has_name)
           || std::ranges::any_of(settings_of_single_algorithms, has_name);
}

/// Every word of a setting.
Axis words_of(const Parameter& parameter) {
    Axis axis;
    for (const auto& word : parameter.choices())
        axis.push_back({{std::string(parameter.name), std::string(word.text)}});
    return axis;
}

/// Value axes of the settings that `traversal` declares: those listed above, and words of settings that only
/// it has.
std::vector<Axis> axes_of(const Traversal& traversal) {
    std::vector<Axis> axes{axis_of_directions(),
                           axis_of({"precision", {"float", "double"}}),
                           {{{"rounding", "safe"}},
                            {{"rounding", "nearest"}},
                            {{"rounding", "published"}},
                            {{"rounding", "safe"}, {"placement", "exact"}}},
                           axis_of({"group_size", {"1", "8", "32", "64"}})};
    if (traversal.name() == "tiled") axes.back().push_back({{"group_size", "256"}});
    for (const auto* settings : {&shared_settings, &settings_of_single_algorithms})
        for (const auto& setting : *settings) axes.push_back(axis_of(setting));
    axes.emplace_back();
    for (const auto& [rule, word] : contact_rules()) axes.back().push_back({{"contact_rule", word}});
    std::erase_if(axes, [&](const Axis& axis) { return !declares(traversal, axis.front().begin()->first); });
    for (const auto* parameter : traversal.parameters())
        if (!parameter->takes_integers() && is_own(traversal, *parameter) && !is_listed(parameter->name))
            axes.push_back(words_of(*parameter));
    return axes;
}

/// Replaces the values of a row that need the published data path, which neither the device's broad phase nor
/// order=canonical nor motion=linear nor a margin has, and those whose bounds grow in no way.
SettingTexts resident_row(SettingTexts row) {
    const auto set = [&row](const char* name, const char* value) {
        if (row.contains(name)) row[name] = value;
    };
    set("residency", "resident");
    set("batch", "0");
    set("upload", "seeds");
    set("sizes", "own");
    if (row.at("motion") == "none" && row.at("margin") == "0") return row;
    if (row.at("rounding") == "published") row["rounding"] = "safe";
    if (row.at("motion") == "linear" && row.contains("slabs") && row.at("slabs") == "three")
        row["slabs"] = "all";
    return row;
}

/// Replaces the values of a row that do not go with polygons of equal pressure.
SettingTexts with_one_field(SettingTexts row) {
    if (row.at("contact_rule") != "pressure") return row;
    if ((row.contains("residency") && row.at("residency") == "published") || row.at("motion") == "linear")
        row["contact_rule"] = "sat";
    else
        row["self"] = "off";
    return row;
}

/// Splits a row that combines values that exclude each other: one row with the later ones, one with those of
/// the published data path. Contacts of a frame with a successor need exact decisions; distances are those of
/// one frame.
std::vector<SettingTexts> possible(const std::vector<SettingTexts>& rows) {
    const SettingTexts published{{"broad", "sphere"}, {"order", "any"}, {"margin", "0"}, {"motion", "none"}};
    std::vector<SettingTexts> all;
    for (const auto& row : rows) {
        const bool is_resident = row.at("broad") == "device" || row.at("order") == "canonical"
                                 || row.at("motion") == "linear" || row.at("margin") != "0";
        const auto first = is_resident ? resident_row(row) : row;
        all.push_back(first);
        if (row.at("motion") == "linear") all.back()["decision"] = "exact";
        const bool measures = row.at("contact_rule") == "distance";
        if (measures && row.at("motion") == "linear") all.back()["contact_rule"] = "sat";
        if (first == row) continue;
        all.push_back(row);
        for (const auto& [name, value] : published) all.back()[name] = value;
    }
    for (auto& row : all) row = with_one_field(std::move(row));
    return all;
}

/// The row with the largest group size whose local memory the device can provide.
SettingTexts fitted(const Traversal& traversal, Device& on, SettingTexts row) {
    const std::array devices{&on};
    for (;;) {
        try {
            traversal.check(devices, resolved(traversal, row));
            return row;
        } catch (const InputError& error) {
            const auto size = std::stoi(row.at("group_size"));
            if (std::string_view(error.what()).find("local memory") == std::string_view::npos || size == 1)
                throw;
            row["group_size"] = std::to_string(size / 2);
        }
    }
}

/// Runs both frames of `scene` and compares pairs, digests and contacts with the reference.
void expect_right(Device& on, const Traversal& traversal, const Scene& scene, const SettingTexts& given,
                  std::uint64_t& pairs, std::uint64_t& contacts) {
    SCOPED_TRACE(fmt::format("{} on {}:{}", traversal.name(), on.info().id, text(given)));
    const auto settings = resolved(traversal, given);
    const auto session = prepare_on(on, traversal, scene, settings);
    const auto geometry = geometry_of(settings);
    for (std::size_t i = 0; i < scene.frame_count; ++i) {
        const auto frame = scene.frame(i);
        const auto next = scene.frame((i + 1) % scene.frame_count);
        const FrameInput input(frame, geometry.motion == Motion::linear ? &next : nullptr);
        const auto expected =
            reference(scene, input, geometry, true, Method::brute_force, contact_settings_of(settings));
        const auto result =
            input.next == nullptr ? run_among_all(*session, scene, frame) : session->run(input);
        EXPECT_EQ(result.download(), expected.pairs);
        expect_same_digests(result, expected);
        EXPECT_EQ(result.degenerate, expected.degenerate);
        EXPECT_EQ(result.without_boundary, expected.without_boundary);
        EXPECT_EQ(result.rejected, expected.rejected);
        pairs += result.count;
        contacts += result.contacts;
    }
    on.finish();
}

class Conformance : public OnDevice {};

/// A device and a part of the rows: compilation takes most of the time, and parts can run in parallel.
class CoveringArray : public testing::TestWithParam<std::tuple<std::string, std::size_t>> {
public:
    static constexpr std::size_t parts = 18;

protected:
    static void cover(std::string_view algorithm_name, std::uint64_t seed, std::uint32_t bodies) {
        const auto& [device_id, part] = GetParam();
        const auto& traversal = algorithm(algorithm_name);
        auto& on = device(device_id);
        const auto rows = possible(pairwise(axes_of(traversal)));
        ASSERT_GE(rows.size(), 2 * parts);
        // Where kernels must be compiled, the short form has every fourth row of its part.
        const auto step = device_id == "host" || long_form() ? parts : 4 * parts;
        for (auto i = part; i < rows.size(); i += step) {
            std::uint64_t pairs = 0;
            std::uint64_t contacts = 0;
            expect_right(on, traversal, crowd(seed + i, bodies, 0.8), fitted(traversal, on, rows[i]), pairs,
                         contacts);
            EXPECT_GT(pairs, 0u) << text(rows[i]);
            EXPECT_GT(contacts, 0u) << text(rows[i]);
            if (HasFailure()) return;
        }
    }
};

TEST_P(CoveringArray, Chunked) { cover("chunked", 100, 7); }
// Queues of four items with a balance after each would need thousands of launches per body pair.
TEST_P(CoveringArray, Gproximity) { cover("gproximity", 200, 4); }
TEST_P(CoveringArray, Tiled) { cover("tiled", 400, 7); }
TEST_P(CoveringArray, LeafQuery) { cover("leaf_query", 500, 7); }
TEST_P(CoveringArray, EveryOther) {
    TANDEM_LONG_FORM_ONLY(std::get<0>(GetParam()));
    const std::set<std::string_view> own{"chunked", "gproximity", "tiled", "leaf_query",
                                         "leaf_query_scene"}; // leaf_query covers both of its trees
    for (const auto* traversal : algorithms())
        if (!own.contains(traversal->name())) cover(traversal->name(), 300, 7);
}

TEST_P(Conformance, EveryPreset) {
    const auto scene = crowd(5, 9, 0.9);
    std::uint64_t cells = 0;
    for (const auto* traversal : algorithms()) {
        for (const auto& p : traversal->presets()) {
            auto given = p.texts();
            if (declares(*traversal, "queue_capacity"))
                given["queue_capacity"] = "4096"; // 64 MiB a batch would only cost time
            std::uint64_t pairs = 0;
            std::uint64_t contacts = 0;
            expect_right(on, *traversal, scene, given, pairs, contacts);
            EXPECT_GT(pairs, 100u) << p.name;
            EXPECT_GT(contacts, 100u) << p.name;
            ++cells;
        }
    }
    EXPECT_GE(cells, 9u);
    fmt::print("{} presets on {}\n", cells, GetParam());
}

TEST_P(Conformance, CountAndDigestModesAgreeWithPairs) {
    const auto scene = crowd(11, 8, 0.8);
    const auto frame = scene.frame(1);
    for (const auto* traversal : algorithms()) {
        const auto expected = reference(scene, frame, {}, false, Method::brute_force);
        ASSERT_GT(expected.digest.count, 0u);
        for (const std::string output : {"count", "digest"}) {
            const auto session = prepare_on(on, *traversal, scene, {{"output", output}});
            const auto result = run_among_all(*session, scene, frame);
            EXPECT_EQ(result.count, expected.digest.count);
            if (output == "digest") {
                EXPECT_EQ(result.digest(), expected.digest);
            }
        }
    }
}

TEST_P(Conformance, EmptyAnswerIsEmpty) {
    auto scene = crowd(3, 4, 0.5);
    auto frame = scene.frame(0);
    for (std::size_t i = 0; i < frame.poses.size(); ++i)
        frame.poses[i].translation = Eigen::Vector3d(10.0 * static_cast<double>(i + 1), 0, 0);
    for (const auto* traversal : algorithms()) {
        const auto session = prepare_on(on, *traversal, scene);
        EXPECT_EQ(run_among_all(*session, scene, frame).count, 0u);
        EXPECT_EQ(session->run(frame, {}).count, 0u);
    }
}

TEST_P(Conformance, CapacityOfExactlyTheAnswerNeedsNoRetry) {
    const auto scene = crowd(21, 8, 0.8);
    const auto frame = scene.frame(0);
    const auto expected = reference(scene, frame, {}, true, Method::brute_force);
    for (const auto* traversal : algorithms()) {
        for (const std::uint64_t less : {0u, 1u}) {
            const auto session = prepare_on(on, *traversal, scene,
                                            {{"pair_capacity", std::to_string(expected.digest.count - less)},
                                             {"contact_capacity", std::to_string(expected.contacts - less)}});
            const auto result = run_among_all(*session, scene, frame);
            EXPECT_EQ(result.retries > 0, less > 0);
            expect_same_digests(result, expected);
        }
    }
}

TEST_P(Conformance, TenRunsGiveTheSameSet) {
    const auto scene = crowd(31, 10, 0.9);
    const auto frame = scene.frame(0);
    for (const auto* traversal : algorithms()) {
        const auto session = prepare_on(on, *traversal, scene);
        const auto first = run_among_all(*session, scene, frame).download();
        ASSERT_FALSE(first.empty());
        for (int i = 1; i < 10; ++i) EXPECT_EQ(run_among_all(*session, scene, frame).download(), first);
    }
}

/// A session gets the memory of the previous one, at the same addresses. Cached state of the previous
/// session's commands must not be reused.
TEST_P(Conformance, RepeatedSessionsAtTheSameAddresses) {
    const auto scene = crowd(48, 6, 0.8);
    const auto right = reference(scene, scene.frame(0), {}, true, Method::brute_force);
    for (const auto* traversal : algorithms())
        for (int i = 0; i < 3; ++i) {
            SCOPED_TRACE(traversal->name());
            const auto session = prepare_on(on, *traversal, scene, {{"broad", "device"}});
            for (int run = 0; run < 4; ++run) {
                const auto result = session->run(scene.frame(0));
                expect_same_digests(result, right);
            }
        }
}

TANDEM_ON_DEVICES(Conformance);

INSTANTIATE_TEST_SUITE_P(Devices, CoveringArray,
                         testing::Combine(testing::ValuesIn(device_names()),
                                          testing::Range<std::size_t>(0, CoveringArray::parts)),
                         [](const auto& test) {
                             const auto device_id = std::get<0>(test.param);
                             const auto part = std::get<1>(test.param);
                             const bool is_long = part != 0 && device_id != "host";
                             return fmt::format("{}{}Part{}", device_label(device_id),
                                                is_long ? "OnlyLong" : "", part);
                         });

} // namespace
} // namespace tandem
