// SPDX-License-Identifier: MIT
// Tetrahedra that a frame skips: in no pair of any algorithm, in no bound, and back in the next frame.
#include "algorithms/published/published_frame.h"
#include "tests/support/prepared_trees.h"
#include "harness/frames/frames.h"
#include "harness/verify/oracle/frame_truth.h"
#include "tests/support/on_device.h"
#include "tests/support/flawed.h"
#include "tests/support/long_form.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

using Skipped = std::vector<std::vector<std::uint32_t>>;

/// Every n-th tetrahedron of each body, starting at `first`; n = 0: none.
Skipped every(const Scene& scene, const std::array<std::uint32_t, 3>& n, std::uint32_t first) {
    Skipped result(scene.bodies.size());
    for (std::size_t body = 0; body < result.size(); ++body)
        for (auto t = first; n[body] != 0 && t < scene.meshes[scene.bodies[body].mesh].tetrahedra.size();
             t += n[body])
            result[body].push_back(t);
    return result;
}

/// Frames that skip nothing, some of each body, a different set, all of one body, and again nothing.
std::vector<Frame> frames_of(const Scene& scene) {
    const std::vector<Skipped> skipped{
        {}, every(scene, {7, 3, 2}, 0), every(scene, {0, 5, 1}, 3), every(scene, {0, 1, 0}, 0), {}};
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < skipped.size(); ++i) {
        frames.push_back(scene.frame(i % scene.frame_count));
        frames.back().skipped = skipped[i];
    }
    return frames;
}

/// The pairs of all tetrahedra, without those of skipped ones.
std::vector<Pair> expected(const Scene& scene, const Frame& frame, const Geometry& geometry) {
    auto whole = frame;
    whole.skipped.clear();
    auto pairs = reference(scene, whole, geometry, false, Method::brute_force).pairs;
    std::erase_if(pairs, [&](const auto& pair) { return is_skipped(frame, pair); });
    return pairs;
}

class Skipping : public OnDevice {
protected:
    void expect_other_pairs(const Traversal& traversal, const Preset& preset, const SettingTexts& given,
                            const Scene& scene) {
        auto settings = resolve(traversal.parameters(), preset.values, given, traversal.name());
        SCOPED_TRACE(fmt::format("{} {}{}", traversal.name(), preset.name, text(given)));
        const auto session = prepare_on(on, traversal, scene, settings);
        const auto geometry = geometry_of(session->settings());
        std::size_t left_out = 0;
        for (const auto& frame : frames_of(scene)) {
            const auto pairs = expected(scene, frame, geometry);
            const auto result = run_among_all(*session, scene, frame);
            EXPECT_EQ(result.download(), pairs);
            EXPECT_EQ(result.digest(), digest_of(pairs));
            for (const auto method : {Method::brute_force, Method::sweep})
                EXPECT_EQ(reference(scene, frame, geometry, false, method).pairs, pairs);
            EXPECT_GT(pairs.size(), 100u);
            left_out += frame.skipped.empty() ? 0 : 1;
        }
        EXPECT_EQ(left_out, 3u);
    }
};

TEST_P(Skipping, KeepsAllOtherPairsWithEveryPreset) {
    const auto scene = boxes_scene(3, 4);
    for (const auto* traversal : walks())
        for (const auto& preset : traversal->presets()) {
            SettingTexts given{{"contact_rule", "none"}};
            if (traversal->name() == "gproximity") given["queue_capacity"] = "4096";
            expect_other_pairs(*traversal, preset, given, scene);
        }
}

/// Small chunks make many levels; empty_nodes processes more than the first of them.
TEST_P(Skipping, KeepsAllOtherPairsAtEveryLevel) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = boxes_scene(7, 4); // 2058 tetrahedra: two levels of more than 1024 items
    const auto& traversal = algorithm("chunked");
    for (const std::string leaves : {"2", "4"})
        for (const std::string broad : {"device", "tight"})
            expect_other_pairs(traversal, preset(traversal, "grouped"),
                               {{"leaves", leaves}, {"k", "8"}, {"broad", broad}, {"contact_rule", "none"}},
                               scene);
}

TEST_P(Skipping, WorksInEveryRoundingAndPrecision) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = boxes_scene(2, 4);
    std::size_t cell = 0;
    for (const auto* traversal : algorithms()) {
        for (const std::string precision : {"float", "double"})
            for (const std::string rounding : {"safe", "nearest", "published"})
                // The short form runs every second cell, and the other half with the next algorithm.
                if (long_form() || cell++ % 2 == 0)
                    expect_other_pairs(*traversal, traversal->presets().front(),
                                       {{"k", "18"},
                                        {"precision", precision},
                                        {"rounding", rounding},
                                        {"contact_rule", "none"}},
                                       scene);
        ++cell;
    }
}

/// Checks that every inner node is the union of its children, skipped leaves are empty, and no other node is.
template<class Real>
std::size_t check_nodes(const Scene& scene, const Frame& frame, const PreparedTrees& on_device) {
    const auto k = static_cast<std::size_t>(on_device.geometry().k);
    const auto nodes = on_device.nodes<Real>();
    const auto volumes = on_device.volumes<Real>();
    std::size_t empty = 0;
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
        const auto base = on_device.trees.first_slot(body);
        const auto node = [&](std::uint32_t slot) { return &nodes[slot * k]; };
        std::vector<Real> whole(k);
        std::fill_n(whole.begin(), k / 2, std::numeric_limits<Real>::infinity());
        std::fill(whole.begin() + static_cast<std::ptrdiff_t>(k / 2), whole.end(),
                  -std::numeric_limits<Real>::infinity());
        const auto nothing = whole;
        std::vector<bool> skipped(on_device.bodies.mesh(body).ids.size());
        if (!frame.skipped.empty())
            for (const auto t : frame.skipped[body]) skipped[t] = true;
        std::uint32_t number = 0;
        for (const auto& level : on_device.trees.levels(body)) {
            for (std::uint32_t chunk = 0; chunk < level.chunks; ++chunk) {
                const auto first = chunk * on_device.trees.leaves();
                const auto items = std::min(on_device.trees.leaves(), level.items - first);
                const auto slot = base + level.slot + 2 * first;
                for (std::uint32_t i = 1; i < items; ++i)
                    for (std::size_t word = 0; word < k; ++word) {
                        const auto a = node(slot + 2 * i)[word], b = node(slot + 2 * i + 1)[word];
                        EXPECT_EQ(node(slot + i)[word], word < k / 2 ? std::min(a, b) : std::max(a, b));
                    }
                for (std::uint32_t leaf = items; leaf < 2 * items && number == 0; ++leaf) {
                    const auto width = std::bit_ceil(items);
                    const auto item = first + (leaf >= width ? leaf - width : leaf + items - width);
                    const bool is_empty = std::equal(nothing.begin(), nothing.end(), node(slot + leaf));
                    EXPECT_EQ(is_empty, skipped[on_device.bodies.mesh(body).ids[item]])
                        << body << " " << item;
                    empty += is_empty ? 1 : 0;
                    for (std::size_t word = 0; word < k; ++word)
                        whole[word] = word < k / 2 ? std::min(whole[word], node(slot + leaf)[word])
                                                   : std::max(whole[word], node(slot + leaf)[word]);
                }
            }
            ++number;
        }
        EXPECT_TRUE(std::equal(whole.begin(), whole.end(), &volumes[body * k])) << "volume of body " << body;
    }
    return empty;
}

TEST_P(Skipping, NodesBoundUnskippedTetrahedraOnly) {
    for (const std::uint32_t cells : {2u, 7u}) {
        const auto scene = boxes_scene(cells, 4);
        for (const std::uint32_t leaves : {2u, 32u, 4096u})
            for (const auto sharing : {Bodies::Sharing::by_mesh, Bodies::Sharing::none}) {
                SCOPED_TRACE(fmt::format("{} cells, {} leaves", cells, leaves));
                PreparedTrees on_device(on, scene, {.k = 18}, leaves, on.info().max_group_size == 1 ? 1 : 64,
                                        sharing);
                PublishedFrame published(on_device.bodies, on_device.trees, {on_device.trees.group_size(), 1},
                                         resolved(algorithm("chunked"), {}));
                for (const auto& frame : frames_of(scene)) {
                    if (sharing == Bodies::Sharing::none) {
                        published.initialize(frame);
                        published.prepare_walk({});
                    } else {
                        on_device.update(frame);
                    }
                    std::size_t count = 0;
                    for (const auto& body : frame.skipped) count += body.size();
                    EXPECT_EQ(check_nodes<float>(scene, frame, on_device), count);
                }
            }
    }
}

/// The only part of a body near the others is skipped, so bounds shrink and no body pair is left, on the
/// device too.
TEST_P(Skipping, BodiesWhoseNearPartsAreSkippedFormNoPair) {
    auto scene = boxes_scene(2, 4);
    const auto still = scene.frame(0);
    scene.frame = [still](std::size_t) {
        auto frame = still;
        frame.poses[1].translation = {50, 0, 0};
        for (auto& v : frame.deformed[2]) v += Eigen::Vector3d(100, 0, 0);
        return frame;
    };
    auto frame = scene.frame(0);
    const auto vertex = scene.meshes[1].tetrahedra[5][3];
    frame.deformed[2][vertex] = {0, 0, 0}; // a spike through body 1 and into body 0
    const auto& traversal = algorithm("chunked");
    const auto session = prepare_on(on, traversal, scene, {{"broad", "device"}});
    const auto with = session->run(frame);
    EXPECT_GT(with.body_pairs, 0u);
    EXPECT_GT(with.count, 0u);
    frame.skipped = {{}, {}, around(scene.meshes[1], vertex)};
    const auto without = session->run(frame);
    EXPECT_EQ(without.body_pairs, 0u);
    EXPECT_EQ(without.count, 0u);
}

/// Coordinates that are not finite and flat tetrahedra, skipped as the commands do it, against the exact
/// truth.
TEST_P(Skipping, AgreesWithTheTruth) {
    const auto whole = boxes_scene(3, 4);
    std::vector<Frame> frames{whole.frame(0), whole.frame(1)};
    const auto& mesh = whole.meshes[1];
    make_flat(mesh, frames[0].deformed[2], 40);
    frames[1].deformed[2][mesh.tetrahedra[80][1]].z() = std::numeric_limits<double>::quiet_NaN();
    const auto scene = with_frames(whole, frames);
    const FrameRange range(scene, 0, 1, Degenerate::skip);
    EXPECT_GT(range.flaws().degenerate, 0u);
    EXPECT_GT(range.flaws().non_finite, 0u);
    for (std::size_t i = 0; i < range.size(); ++i) {
        const auto loaded = range.frame(i);
        const auto& frame = *loaded;
        const auto truth = frame_truth(scene, frame, Precision::fp32);
        EXPECT_GT(truth.overlapping.size(), 100u);
        EXPECT_TRUE(truth.invalid.empty());
        for (const auto& list : {truth.touching, truth.overlapping})
            for (const auto& pair : list) EXPECT_FALSE(is_skipped(frame, pair));
        for (const auto* traversal : algorithms()) {
            const auto session = prepare_on(on, *traversal, scene);
            const auto pairs = run_among_all(*session, scene, frame).download();
            for (const auto& pair : pairs) EXPECT_FALSE(is_skipped(frame, pair)) << traversal->name();
            const auto errors = pair_errors(truth, pairs);
            EXPECT_EQ(errors.missed_touching + errors.missed_overlapping, 0u) << traversal->name();
            EXPECT_EQ(errors.invalid, 0u) << traversal->name();
        }
    }
}

TANDEM_ON_DEVICES(Skipping);

} // namespace
} // namespace tandem
