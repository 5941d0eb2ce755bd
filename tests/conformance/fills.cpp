// SPDX-License-Identifier: MIT
// What no stage has written is never read, also not in a frame whose buffers overflow: every buffer that a
// frame writes is filled with a word before each frame, and every new one at once. Answers must be those of
// the reference.
#include "tests/support/limited.h"
#include "tests/support/long_form.h"
#include "tests/support/scenes.h"
#include "algorithms/pipeline/pipeline.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

#include <deque>

namespace tandem {
namespace {

using namespace support;

/// Buffers that a session carries from frame to frame. Every other buffer is filled, but for tables of
/// uploaded(): a new one until it is named here.
constexpr std::array<std::string_view, 9> not_filled{
    "vertices",
    "vertices of the next frame",
    "order of bodies",
    "tetrahedra that take part",
    "marks of tiles", // each frame clears those that it sets
    "tetrahedra of the scene",
    "bodies of the scene",
    "state of the scene's tree",
    "skipped tetrahedra"}; // those of the tests' own algorithm

/// Values of a setting, or of what no setting is: the word, and whether memory suffices for a part of the
/// pairs only.
using Values = std::pair<std::string, std::vector<std::string>>;

const std::vector<Values> every_path{{"output", {"pairs", "contacts", "count", "digest"}},
                                     {"self", {"off", "on"}},
                                     {"capacities", {"1", "7", "random"}},
                                     {"word", {"0x55555555", "0xffffffff", "0x00ffffff"}},
                                     {"memory", {"all", "little"}},
                                     {"decision", {"fp32", "recheck", "exact"}},
                                     {"contact_rule", {"opposing", "sat", "none"}},
                                     {"pair_layout", {"slots", "items"}},
                                     {"tree", {"body", "scene"}},
                                     {"slabs", {"three", "all", "touched"}},
                                     {"schedule", {"group", "item"}},
                                     {"leaves", {"2", "32"}},
                                     {"most_seeds", {"1", "256"}},
                                     {"seed_threshold", {"1", "1e7"}}};
const std::vector<Values> resident_path{{"motion", {"none", "linear"}},
                                        {"margin", {"0", "0.01"}},
                                        {"order", {"any", "canonical"}},
                                        {"broad", {"device", "sphere"}}};

/// Rows of settings that together have every pair of two values.
std::vector<SettingTexts> rows_of(const Traversal& traversal, bool published) {
    std::vector<Axis> axes;
    const auto add = [&](const Values& values) {
        const auto& name = values.first;
        const bool is_setting = name != "capacities" && name != "word" && name != "memory";
        if (is_setting && !declares(traversal, name)) return;
        Axis axis;
        for (const auto& value : values.second) axis.push_back({{name, value}});
        axes.push_back(axis);
    };
    for (const auto& values : every_path) add(values);
    for (const auto& values : resident_path)
        if (!published) add(values);
    auto rows = pairwise(axes);
    for (auto& row : rows) {
        if (row["output"] == "contacts" && row["contact_rule"] == "none") row["contact_rule"] = "sat";
        if (row.contains("order") && (row["output"] == "count" || row["output"] == "digest"))
            row["order"] = "any";
        if (published) row["residency"] = "published", row["broad"] = "sphere";
        if (!row.contains("motion") || row["motion"] == "none") continue;
        row["decision"] = "exact"; // what contacts of a frame with a successor need
        if (row.contains("slabs") && row["slabs"] == "three") row["slabs"] = "all";
    }
    return rows;
}

/// Bodies of three meshes that all move, one of them deformable.
Scene moving_crowd(std::uint64_t seed) {
    auto scene = crowd(seed, 5, 0.7);
    for (auto& body : scene.bodies) body.fixed = false;
    scene.digest = digest_of(scene);
    return scene;
}

/// A row without what no setting is, and with its capacities.
SettingTexts settings_of(const Traversal& traversal, SettingTexts row, Random& random) {
    const auto capacities = row.at("capacities");
    for (const auto* parameter : traversal.parameters())
        if (parameter->name.ends_with("_capacity"))
            row[std::string(parameter->name)] =
                capacities == "random" ? std::to_string(2 + random.next() % 3000) : capacities;
    row["work_items"] = "64"; // more groups would only cost time
    if (declares(traversal, "queue_bytes")) row["queue_bytes"] = "65536";
    // Queues of a few items need thousands of launches for a body pair.
    if (declares(traversal, "queue_capacity") && capacities != "random") row["queue_capacity"] = "40";
    if (declares(traversal, "rebuild")) row["rebuild"] = "1"; // a tree that is kept is carried state
    for (const char* other : {"capacities", "word", "memory"}) row.erase(other);
    return row;
}

struct Seen {
    std::uint64_t frames = 0, retries = 0, batches = 0, contacts = 0;
};

class Fills : public OnDevice {
protected:
    /// Runs the scene's frames, and the first one again, each with filled buffers.
    void expect_right(const Traversal& traversal, const SettingTexts& row, std::uint64_t seed);

    Seen seen;

private:
    const ReferenceAnswer& right_for(std::uint64_t seed, const Scene& scene, std::size_t number,
                                     const Settings& settings);

    struct Known {
        std::uint64_t seed;
        std::size_t number;
        Geometry geometry;
        ContactSettings settings;
        ReferenceAnswer right;
    };
    std::deque<Known> known_; ///< rows share few of them
};

const ReferenceAnswer& Fills::right_for(std::uint64_t seed, const Scene& scene, std::size_t number,
                                        const Settings& settings) {
    const auto geometry = geometry_of(settings);
    const auto contacts = contact_settings_of(settings);
    for (const auto& known : known_)
        if (known.seed == seed && known.number == number && known.geometry == geometry
            && known.settings == contacts)
            return known.right;
    const auto frame = scene.frame(number);
    const auto next = scene.frame(1 - number);
    const FrameInput input(frame, geometry.motion == Motion::linear ? &next : nullptr);
    return known_
        .emplace_back(seed, number, geometry, contacts,
                      reference(scene, input, geometry, true, Method::brute_force, contacts))
        .right;
}

void expect_equal(const FrameResult& result, const ReferenceAnswer& right, const Settings& settings) {
    EXPECT_EQ(result.count, right.digest.count);
    const auto output = settings[parameters::output];
    if (output == Output::count) return;
    EXPECT_EQ(result.digest(), right.digest);
    if (!has_pairs(output)) return;
    EXPECT_EQ(result.download(), right.pairs);
    if (settings[parameters::contact_rule] == ContactRule::none) return;
    EXPECT_EQ(result.rejected, right.rejected);
    EXPECT_EQ(result.without_boundary, right.without_boundary);
    EXPECT_EQ(result.contact_digest(), right.contact_digest);
}

void Fills::expect_right(const Traversal& traversal, const SettingTexts& row, std::uint64_t seed) {
    SCOPED_TRACE(fmt::format("{} on {}:{}", traversal.name(), on.info().id, text(row)));
    Random random(seed);
    const auto scene = moving_crowd(seed % 3);
    const auto given = settings_of(traversal, row, random);
    const auto word = static_cast<std::uint32_t>(std::stoul(row.at("word"), nullptr, 16));
    const auto settings = resolved(traversal, given);
    std::optional<Limited> limit;
    if (row.at("memory") == "little") // the published path needs room for all of its seeds
        limit.emplace(on,
                      least_bytes(on, traversal, scene, given) + (is_published(settings) ? 3000000 : 150000));
    const auto session = prepare_on(on, traversal, scene, settings);
    for (const std::size_t i : {0, 1, 0}) {
        const auto& right = right_for(seed % 3, scene, i, settings);
        const auto frame = scene.frame(i);
        const auto next = scene.frame(1 - i);
        const FrameInput input(frame, settings[parameters::motion] == Motion::linear ? &next : nullptr);
        on.fill_buffers(word, not_filled);
        FrameResult result;
        ASSERT_NO_THROW(result = session->run(input));
        ++seen.frames;
        seen.retries += result.retries;
        seen.batches += result.batches - 1;
        seen.contacts += result.contacts;
        expect_equal(result, right, settings);
    }
    on.check_guards();
}

/// On PoCL, whose compiler takes most of the time, the short form has a thirteenth of the rows.
TEST_P(Fills, NothingIsReadBeforeItIsWritten) {
    std::uint64_t rows_run = 0;
    for (const auto* traversal : algorithms())
        for (const bool published : {false, true}) {
            if (published && !declares(*traversal, "residency")) continue;
            const auto rows = rows_of(*traversal, published);
            const std::size_t step = long_form() || GetParam() == "host" ? 1 : 13;
            for (std::size_t i = 0; i < rows.size(); i += step, ++rows_run) {
                expect_right(*traversal, rows[i], 900 + i);
                if (HasFailure()) return;
            }
        }
    EXPECT_GT(seen.retries, rows_run / 2);
    EXPECT_GT(seen.batches, 0u);
    EXPECT_GT(seen.contacts, 0u);
    fmt::print("{} rows, {} frames, {} retries, {} further batches on {}\n", rows_run, seen.frames,
               seen.retries, seen.batches, GetParam());
}

TANDEM_ON_DEVICES(Fills);

} // namespace
} // namespace tandem
