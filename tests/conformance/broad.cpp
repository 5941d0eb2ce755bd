// SPDX-License-Identifier: MIT
// The device's broad phase: its body pairs against those of a plain double loop over the root volumes that
// lie on the device, and every algorithm and preset with every broad phase against brute force.
#include "algorithms/broad/broad_stage.h"
#include "algorithms/status.clh"
#include "harness/walk.h"
#include "scenes/error.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numeric>

namespace tandem {
namespace {

using namespace testing_support;

constexpr std::uint32_t guard = 0xabcdabcd;

/// `places`: those of each body by frame. Bodies of one mesh that do not turn.
Scene still_scene(Mesh mesh, const std::vector<std::vector<Eigen::Vector3d>>& places) {
    Scene scene;
    scene.name = scene.key = "still";
    scene.meshes = {std::move(mesh)};
    scene.bodies.resize(places.front().size());
    scene.frame_count = places.size();
    scene.frame = [places](std::size_t frame) {
        Frame result;
        result.deformed.resize(places[frame].size());
        for (const auto& place : places[frame])
            result.poses.push_back({Eigen::Quaterniond::Identity(), place});
        return result;
    };
    scene.digest = digest_of(scene);
    return scene;
}

Mesh one_tetrahedron() {
    Mesh mesh;
    mesh.name = "one";
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    complete_mesh(mesh, "one");
    return mesh;
}

/// From 0 to 1 along each axis.
Mesh unit_cube() {
    Random random(1);
    auto cube = shaken_box(1, random);
    for (auto& v : cube.vertices)
        for (int i = 0; i < 3; ++i) v[i] = v[i] < 0 ? 0 : 1;
    return cube;
}

/// side x side x side cubes, all of which touch their neighbours and no more.
Scene lattice(std::uint32_t side) {
    std::vector<Eigen::Vector3d> places;
    for (std::uint32_t i = 0; i < side * side * side; ++i)
        places.emplace_back(i % side, i / side % side, i / side / side);
    return still_scene(unit_cube(), {places});
}

/// A row of cubes that touch along x, which frame 1 turns round.
Scene row_of_cubes(std::uint32_t bodies) {
    std::vector<std::vector<Eigen::Vector3d>> places(2);
    for (std::uint32_t i = 0; i < bodies; ++i) {
        places[0].emplace_back(i, 0, 0);
        places[1].emplace_back(bodies - i, 0, 0);
    }
    return still_scene(unit_cube(), places);
}

/// Single tetrahedra strewn in a cube, somewhere else in each of two frames but for the fixed ones: every
/// `fixed_step`-th body.
Scene gravel(std::uint64_t seed, std::uint32_t bodies, double spread, std::uint32_t fixed_step) {
    Random random(seed);
    std::vector<std::vector<Eigen::Vector3d>> places(2);
    for (std::uint32_t i = 0; i < bodies; ++i) {
        for (auto& frame : places)
            frame.emplace_back(random.uniform() * spread, random.uniform() * spread,
                               random.uniform() * spread);
        if (i % fixed_step == 0) places[1].back() = places[0].back();
    }
    auto scene = still_scene(one_tetrahedron(), places);
    for (std::uint32_t i = 0; i < bodies; i += fixed_step) scene.bodies[i].fixed = true;
    return scene;
}

/// Closed overlap of two root volumes.
template<class Real>
bool overlapping(const Real* a, const Real* b, std::size_t axes) {
    for (std::size_t axis = 0; axis < axes; ++axis)
        if (!(a[axis] <= b[axes + axis] && b[axis] <= a[axes + axis])) return false;
    return true;
}

template<class Real>
std::vector<BodyPair> expected_pairs(const DeviceScene& on, const Scene& scene) {
    const auto k = static_cast<std::size_t>(on.geometry().k);
    std::vector<Real> nodes(on.slots() * k);
    on.device().download(on.nodes(), std::as_writable_bytes(std::span(nodes)));
    std::vector<BodyPair> pairs;
    for (const auto& pair : all_pairs(scene))
        if (overlapping(&nodes[on.body_rows()[pair.a * 8 + 2] * k],
                        &nodes[on.body_rows()[pair.b * 8 + 2] * k], k / 2))
            pairs.push_back(pair);
    return pairs;
}

/// The broad phase alone, on a scene that has been refitted.
class Search {
public:
    Search(Device& device, const Scene& scene, const Geometry& geometry, std::uint32_t group_size,
           std::uint32_t groups)
        : scene_(scene),
          on_(device, scene, geometry, 4, device.info().max_group_size == 1 ? 1 : group_size,
              Residency::resident),
          stage_(on_, scene, groups),
          status_(device.allocate(STATUS_WORDS * 4, "status")) {}

    void go_to(std::size_t frame) { on_.update(scene_.frame(frame)); }
    void sort_by(std::size_t frame) { stage_.sort(scene_.frame(frame)); }

    std::vector<BodyPair> expected() const {
        return on_.geometry().precision == Precision::twice ? expected_pairs<double>(on_, scene_)
                                                            : expected_pairs<float>(on_, scene_);
    }

    /// The pairs found, sorted; their number in `count`. Checks that nothing is written past `capacity`.
    std::vector<BodyPair> found(std::uint32_t capacity, std::uint64_t& count) {
        std::vector<std::uint32_t> rows(2 * (capacity + stage_.most_pairs() + 1), guard);
        const auto pairs = on_.device().allocate(rows.size() * 4, "pairs and guards");
        on_.device().upload(pairs, bytes_of(rows));
        on_.device().clear(status_, STATUS_WORDS * 4);
        stage_.launch(pairs, capacity, status_);
        std::vector<std::uint32_t> status(STATUS_WORDS);
        on_.device().download(status_, std::as_writable_bytes(std::span(status)));
        on_.device().download(pairs, std::as_writable_bytes(std::span(rows)));
        count = status[STATUS_BODY_PAIRS] | std::uint64_t{status[STATUS_BODY_PAIRS + 1]} << 32;
        const auto written = std::min<std::uint64_t>(count, capacity);
        std::vector<BodyPair> result;
        for (std::size_t i = 0; i < written; ++i) result.push_back({rows[2 * i], rows[2 * i + 1]});
        for (std::size_t i = 2 * written; i < rows.size(); ++i)
            EXPECT_EQ(rows[i], guard) << "word " << i << " of a buffer for " << capacity << " pairs";
        std::sort(result.begin(), result.end());
        return result;
    }

    void expect_right() {
        const auto right = expected();
        std::uint64_t count = 0;
        EXPECT_EQ(found(static_cast<std::uint32_t>(right.size()) + 3, count), right);
        EXPECT_EQ(count, right.size());
    }

private:
    const Scene& scene_;
    DeviceScene on_;
    BroadStage stage_;
    Buffer status_;
};

class BroadOnDevice : public testing::TestWithParam<std::string> {};

TEST_P(BroadOnDevice, EqualsADoubleLoopOverTheRootVolumes) {
    auto& on = device(GetParam());
    for (const auto& geometry :
         {Geometry{}, Geometry{.k = 8}, Geometry{.k = 8, .precision = Precision::twice},
          Geometry{.k = 18, .precision = Precision::twice}}) {
        const auto scene = crowd(77, 40, 2.5);
        Search search(on, scene, geometry, 64, 100);
        search.sort_by(0);
        for (std::size_t frame = 0; frame < scene.frame_count; ++frame) {
            search.go_to(frame);
            const auto pairs = search.expected().size();
            EXPECT_GT(pairs, 20u);
            EXPECT_LT(pairs, all_pairs(scene).size() / 2);
            search.expect_right();
        }
    }
}

/// 25 tiles, of which a group takes several, by batches of as many as it has work-items; an order that is no
/// longer right; every third body fixed, so that a tile is fixed in part and others are as a whole.
TEST_P(BroadOnDevice, ManyTilesInAnyOrder) {
    auto& on = device(GetParam());
    const auto scene = gravel(3, 800, 12, 3);
    for (const std::uint32_t groups : {1u, 7u, 100000u}) {
        for (const std::uint32_t group_size : {1u, 8u, 32u}) {
            Search search(on, scene, {}, group_size, groups);
            for (const std::size_t order : {0u, 1u}) {
                search.sort_by(order);
                search.go_to(1 - order);
                EXPECT_GT(search.expected().size(), 400u);
                search.expect_right();
            }
        }
    }
}

TEST_P(BroadOnDevice, TouchingOverlaps) {
    auto& on = device(GetParam());
    const auto scene = lattice(5);
    for (const auto& geometry : {Geometry{}, Geometry{.precision = Precision::twice}}) {
        Search search(on, scene, geometry, 32, 100);
        search.sort_by(0);
        search.go_to(0);
        // Neighbours by a face, an edge or a corner: ((3 * 5 - 2)^3 - 5^3) / 2.
        EXPECT_EQ(search.expected().size(), 1036u);
        search.expect_right();
    }
}

/// Unions of tiles that touch and do no more, from either side.
TEST_P(BroadOnDevice, TouchingTilesOverlap) {
    auto& on = device(GetParam());
    const auto scene = row_of_cubes(100);
    Search search(on, scene, {}, 32, 100);
    for (const std::size_t order : {0u, 1u}) {
        for (const std::size_t frame : {0u, 1u}) {
            search.sort_by(order);
            search.go_to(frame);
            EXPECT_EQ(search.expected().size(), 99u);
            search.expect_right();
        }
    }
}

TEST_P(BroadOnDevice, FixedBodiesMeetMovingOnesOnly) {
    auto& on = device(GetParam());
    for (const std::uint32_t moving : {0u, 1u, 33u}) {
        auto scene = lattice(4);
        for (std::size_t i = moving; i < scene.bodies.size(); ++i) scene.bodies[i].fixed = true;
        Search search(on, scene, {}, 32, 100);
        search.sort_by(0);
        search.go_to(0);
        EXPECT_EQ(search.expected().empty(), moving == 0);
        search.expect_right();
    }
}

TEST_P(BroadOnDevice, OneBodyHasNoPairs) {
    auto& on = device(GetParam());
    const auto scene = still_scene(one_tetrahedron(), {{Eigen::Vector3d(1, 2, 3)}});
    Search search(on, scene, {}, 32, 100);
    search.sort_by(0);
    search.go_to(0);
    search.expect_right();
}

TEST_P(BroadOnDevice, NothingIsWrittenPastTheCapacity) {
    auto& on = device(GetParam());
    const auto scene = gravel(9, 200, 6, 1000);
    Search search(on, scene, {}, 32, 100);
    search.sort_by(0);
    search.go_to(0);
    const auto right = search.expected();
    const auto all = static_cast<std::uint32_t>(right.size());
    ASSERT_GT(all, 100u);
    for (const std::uint32_t capacity : {1u, all - 1, all, all + 1}) {
        std::uint64_t count = 0;
        const auto found = search.found(capacity, count);
        EXPECT_EQ(count, all);
        EXPECT_EQ(found.size(), std::min(capacity, all));
        EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
        EXPECT_TRUE(std::includes(right.begin(), right.end(), found.begin(), found.end()));
    }
}

/// Every preset with every broad phase gives the answer of the reference, or says why it cannot.
TEST_P(BroadOnDevice, EveryPresetWithEveryBroadPhase) {
    auto& on = device(GetParam());
    const auto scene = crowd(5, 12, 1.5);
    std::uint64_t cells = 0;
    for (const auto* traversal : algorithms()) {
        for (const auto& p : traversal->presets()) {
            for (const std::string broad : {"sphere", "tight", "device"}) {
                Settings given{{"broad", broad}};
                if (p.values.contains("groups")) given["queue_bytes"] = "1048576";
                const Cell cell{traversal, p.name,
                                resolve(traversal->parameters(), p.values, given, traversal->name()), &on};
                SCOPED_TRACE(fmt::format("{} {}{}", traversal->name(), p.name, text(given)));
                if (broad == "device" && p.name != "resident" && p.name != "fair") {
                    EXPECT_THROW(traversal->check(cell.settings, on.info()), InputError);
                    continue;
                }
                Walk walk(cell, scene);
                EXPECT_EQ(walk.session->finds_pairs(), broad == "device");
                for (std::size_t i = 0; i < scene.frame_count; ++i) {
                    const auto frame = scene.frame(i);
                    const auto right =
                        reference(scene, frame, geometry_of(cell.settings), true, Method::brute_force);
                    const auto result = walk.run(frame);
                    ASSERT_GT(result.count, 0u);
                    EXPECT_EQ(walk.session->digest(result), right.digest);
                    EXPECT_EQ(walk.session->contact_digest(result), right.contact_digest);
                    EXPECT_GT(result.body_pairs, 0u);
                    EXPECT_LT(result.body_pairs, all_pairs(scene).size());
                }
                on.finish();
                ++cells;
            }
        }
    }
    EXPECT_GE(cells, 20u);
}

/// A buffer for all pairs but one grows once, one for all of them not at all.
TEST_P(BroadOnDevice, ACapacityOfExactlyTheBodyPairsNeedsNoRetry) {
    auto& on = device(GetParam());
    const auto scene = crowd(8, 14, 1.5);
    const auto frame = scene.frame(0);
    const auto right = reference(scene, frame, {}, true, Method::brute_force);
    Search search(on, scene, {}, 32, 100);
    search.sort_by(0);
    search.go_to(0);
    const auto pairs = search.expected().size();
    for (const auto* traversal : algorithms()) {
        for (const std::uint64_t capacity : {std::uint64_t{1}, pairs - 1, pairs}) {
            const auto settings = resolve(
                traversal->parameters(), {},
                {{"broad", "device"}, {"body_pair_capacity", std::to_string(capacity)}}, traversal->name());
            const std::array devices{&on};
            const auto session = traversal->prepare(devices, scene, settings);
            const auto result = session->run(frame, {});
            EXPECT_EQ(result.body_pairs, pairs);
            EXPECT_EQ(result.retries, capacity < pairs ? 1u : 0u);
            EXPECT_EQ(session->digest(result), right.digest);
            EXPECT_EQ(session->contact_digest(result), right.contact_digest);
        }
    }
}

TEST_P(BroadOnDevice, RefusesPairsFromTheHost) {
    auto& on = device(GetParam());
    const auto scene = crowd(8, 4, 0.5);
    for (const auto* traversal : algorithms()) {
        const auto settings = resolve(traversal->parameters(), {}, {{"broad", "device"}}, traversal->name());
        const std::array devices{&on};
        const auto session = traversal->prepare(devices, scene, settings);
        EXPECT_THROW(session->run(scene.frame(0), all_pairs(scene)), InputError);
    }
}

/// The commands of a resident chunked frame: the same for frames of different answers, one wait, and the
/// search booked as what it is.
TEST_P(BroadOnDevice, ResidentChunkedIsOneSequence) {
    auto& on = device(GetParam());
    const auto scene = gravel(10, 300, 5, 1000);
    const auto& traversal = algorithm("chunked");
    const auto settings = resolve(traversal.parameters(), {}, {{"broad", "device"}}, traversal.name());
    const std::array devices{&on};
    const auto session = traversal.prepare(devices, scene, settings);
    session->run(scene.frame(0), {}); // sorts the bodies
    on.finish();
    std::vector<std::vector<std::string>> sequences;
    std::vector<std::uint64_t> found;
    for (const std::size_t frame : {0u, 1u}) {
        const auto result = session->run(scene.frame(frame), {});
        EXPECT_EQ(result.retries, 0u);
        found.push_back(result.body_pairs);
        std::uint64_t waits = 0, searches = 0;
        sequences.emplace_back();
        for (const auto& e : on.finish().events) {
            if (e.command == Command::host_work) continue;
            waits += e.blocked ? 1 : 0;
            searches += e.command == Command::launch && e.stage == Stage::broad ? 1 : 0;
            sequences.back().push_back(fmt::format("{} {} {}", e.label, e.groups, e.group_size));
        }
        EXPECT_EQ(waits, 1u);
        EXPECT_EQ(searches, 2u);
    }
    EXPECT_NE(found[0], found[1]);
    EXPECT_EQ(sequences[0], sequences[1]);
}

INSTANTIATE_TEST_SUITE_P(Devices, BroadOnDevice, testing::ValuesIn(device_names()),
                         [](const auto& test) { return device_label(test.param); });

} // namespace
} // namespace tandem
