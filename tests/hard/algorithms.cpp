// SPDX-License-Identifier: MIT
// Every algorithm on every device misses no intersecting pair of any family with rounding=safe.
#include "algorithms/bodies/origin.h"
#include "algorithms/narrow_phase/contact_settings.h"
#include "harness/frames/frames.h"
#include "harness/verify/oracle/motion_truth.h"
#include "base/error.h"
#include "scenes/hard/hard.h"
#include "tests/support/on_device.h"
#include "tests/support/flawed.h"
#include "tests/support/long_form.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

std::string specification(const HardFamily& family) {
    if (family.scene != nullptr) return fmt::format("hard:{}", family.name);
    return fmt::format("hard:{}:pairs=36,together=18", family.name);
}

#ifdef TANDEM_SANITIZED // sanitized host kernels exist for two geometries only
constexpr std::array tested{"8", "18"};
#else
constexpr std::array tested{"8", "18", "26"};
#endif

/// The world vertices of all bodies in one frame, one after the other.
std::vector<Eigen::Vector3d> all_vertices(const Scene& scene, const Frame& frame) {
    std::vector<Eigen::Vector3d> all;
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        if (scene.bodies[body].deformable)
            all.insert(all.end(), frame.deformed[body].begin(), frame.deformed[body].end());
        else
            for (const auto& v : scene.meshes[scene.bodies[body].mesh].vertices)
                all.push_back(frame.poses[body].rotation * v + frame.poses[body].translation);
    return all;
}

/// The same tetrahedra as one deformable body, which then meets itself.
Scene as_one_body(const Scene& scene) {
    Mesh mesh;
    mesh.vertices = all_vertices(scene, scene.frame(0));
    std::uint32_t first = 0;
    for (const auto& body : scene.bodies) {
        for (auto tetrahedron : scene.meshes[body.mesh].tetrahedra) {
            for (auto& vertex : tetrahedron) vertex += first;
            mesh.tetrahedra.push_back(tetrahedron);
        }
        first += static_cast<std::uint32_t>(scene.meshes[body.mesh].vertices.size());
    }
    complete_mesh(mesh, "one body");
    Scene one;
    one.name = one.key = "one body of " + scene.key;
    one.meshes = {std::move(mesh)};
    one.bodies = {{.mesh = 0, .deformable = true}};
    one.frame_count = scene.frame_count;
    one.frame = [scene](std::size_t i) {
        return Frame{.poses = {Pose{}}, .deformed = {all_vertices(scene, scene.frame(i))}};
    };
    one.digest = digest_of(one);
    return one;
}

constexpr const char* few = "work_items=64 pair_capacity=8192 contact_rule=none";

class HardAlgorithms : public OnDevice {
protected:
    void expect_none_missed(const Traversal& traversal, const Scene& scene, std::span<const Frame> frames,
                            SettingTexts given) {
        if (traversal.name() == "gproximity") given["queue_bytes"] = "1048576";
        given["origin"] = "world"; // some families are hard because they are far from it
        const auto session = prepare_on(on, traversal, scene, given);
        for (const auto& frame : frames) {
            const Positions positions{Precision::fp32, Placement::rounded,
                                      session->settings()[parameters::origin],
                                      session->settings()[parameters::self]};
            const auto truth = frame_truth(scene, counted_from(session->origin(), frame), positions);
            const auto result = run_among_all(*session, scene, frame);
            const auto pairs = result.download();
            const auto errors = pair_errors(truth, pairs);
            EXPECT_EQ(errors.missed_touching, 0u) << "of " << truth.touching.size();
            EXPECT_EQ(errors.missed_overlapping, 0u) << "of " << truth.overlapping.size();
            met_ += truth.touching.size() + truth.overlapping.size();
            for (const auto& pair : pairs) ASSERT_FALSE(is_skipped(frame, pair));
        }
    }

    std::uint64_t met_ = 0;
};

TEST_P(HardAlgorithms, MissNothing) {
    std::size_t number = 0;
    for (const auto& family : hard_families()) {
        if (family.name == "not-finite") continue;
        ++number;
        const auto scene = make_scene(specification(family));
        for (const auto* traversal : algorithms())
            for (const std::string k : tested) {
                if (k == "26" && GetParam() != "host") continue; // compilation takes longest for it
                // In short form, devices that compile use one k per family, alternating between families.
                if (!long_form() && GetParam() != "host" && (k == "8") == (number % 2 == 0)) continue;
                SCOPED_TRACE(fmt::format("{} {} k={}", family.name, traversal->name(), k));
                expect_none_missed(
                    *traversal, scene, std::array{scene.frame(0), scene.frame(scene.frame_count - 1)},
                    texts(fmt::format("k={} self={} origin={} {}", k, family.self ? "on" : "off",
                                      family.distant ? "auto" : "world", few)));
            }
    }
    EXPECT_GT(met_, 10000u);
}

/// The tetrahedra of each family as one body that meets itself.
TEST_P(HardAlgorithms, MissNothingWithinABody) {
    std::size_t number = 0;
    for (const auto& family : hard_families()) {
        if (family.name == "not-finite") continue;
        const auto scene = as_one_body(make_scene(specification(family)));
        ++number;
        for (std::size_t i = 0; i < algorithms().size(); ++i) {
            // Devices that compile take one algorithm per family in the short form.
            if (!long_form() && GetParam() != "host" && i != number % algorithms().size()) continue;
            const auto* traversal = algorithms()[i];
            SCOPED_TRACE(fmt::format("{} {}", family.name, traversal->name()));
            expect_none_missed(*traversal, scene,
                               std::array{scene.frame(0), scene.frame(scene.frame_count - 1)},
                               texts(fmt::format("k=18 self=on {}", few)));
        }
    }
    EXPECT_GT(met_, GetParam() == "host" ? 10000u : 1000u);
}

/// No pair that meets between two frames is missed: by the families about motion, and by all others that
/// move.
TEST_P(HardAlgorithms, MissNothingOnTheWay) {
    std::size_t number = 0;
    for (const auto& family : hard_families()) {
        const auto scene = make_scene(specification(family));
        if (family.name == "not-finite" || scene.frame_count < 2) continue;
        const auto from = scene.frame(0), to = scene.frame(1);
        ++number;
        for (const std::string precision : {"float", "double"}) {
            if (!long_form() && GetParam() != "host" && precision == "double") continue;
            const auto self = family.self ? SelfPairs::on : SelfPairs::off;
            const auto truth = motion_truth(scene, from, to,
                                            {precision == "float" ? Precision::fp32 : Precision::fp64,
                                             Placement::rounded, Origin::world, self});
            met_ += truth.colliding.size();
            for (std::size_t i = 0; i < algorithms().size(); ++i) {
                if (!long_form() && GetParam() != "host" && i != number % algorithms().size()) continue;
                const auto* traversal = algorithms()[i];
                SCOPED_TRACE(fmt::format("{} {} {}", family.name, traversal->name(), precision));
                const int k = family.motion && GetParam() == "host" ? 26 : 18;
                auto given = texts(fmt::format("k={} precision={} self={} motion=linear origin=world {}", k,
                                               precision, family.self ? "on" : "off", few));
                if (traversal->name() == "gproximity") given["queue_bytes"] = "1048576";
                const auto found =
                    prepare(*traversal, scene, given)->run({from, to}, all_pairs(scene, self)).download();
                EXPECT_TRUE(std::ranges::includes(found, truth.colliding));
            }
        }
    }
    EXPECT_GT(number, 10u);
    EXPECT_GT(met_, 100u);
}

/// With decision=exact, k changes rejected pairs only. The devices' kernels compute equal bits, so the host
/// runs every k.
TEST(HardContacts, AreEqualForEveryK) {
    const auto& tiled = algorithm("tiled");
    std::uint64_t contacts = 0;
    std::set<std::uint64_t> counts;
    const auto expect_equal = [&](const std::string& of, const std::string& rounding,
                                  std::span<const std::string> all_k) {
        const auto scene = make_scene(of);
        std::optional<FrameResult> first;
        for (const auto& k : all_k) {
            SCOPED_TRACE(fmt::format("{} rounding={} k={}", of, rounding, k));
            const SettingTexts given{
                {"k", k}, {"rounding", rounding}, {"output", "contacts"}, {"decision", "exact"}};
            const auto settings = resolved(tiled, given);
            ASSERT_TRUE(contacts_are_equal_for_every_k(settings));
            auto result = prepare_on(device("host"), tiled, scene, settings)->run(scene.frame(0));
            counts.insert(result.count);
            if (!first)
                first = std::move(result);
            else
                EXPECT_EQ(result.contact_digest(), first->contact_digest());
        }
        contacts += first->contacts;
    };
#ifdef TANDEM_SANITIZED
    const std::vector<std::string> all_k{"8", "18"}, nested{"18"};
#else
    const std::vector<std::string> all_k{"6", "8", "12", "14", "16", "18", "20", "24", "26"},
        nested{"6", "12", "16", "18"};
#endif
    for (const auto& family : hard_families())
        if (family.name != "not-finite") expect_equal(specification(family), "safe", all_k);
    expect_equal("colosseum", "safe", all_k);
    expect_equal("colosseum", "nearest", nested);
    EXPECT_GT(contacts, 180'000u);
    EXPECT_GT(counts.size(), 10u) << "candidate pairs depend on k";
}

/// Families with flat tetrahedra and non-finite coordinates under --degenerate skip: no pair contains a
/// skipped tetrahedron, and the intersecting pairs of the rest are complete.
TEST_P(HardAlgorithms, MissNoPairOfUnskippedTetrahedra) {
    std::uint64_t skipped = 0, flat = 0;
    const auto run = [&](const Scene& scene) {
        const FrameRange range(scene, 0, scene.frame_count - 1, Degenerate::skip);
        EXPECT_TRUE(range.flaws().any()) << scene.key;
        skipped += range.flaws().non_finite;
        flat += range.flaws().degenerate;
        std::vector<Frame> frames;
        for (std::size_t i = 0; i < range.size(); ++i) frames.push_back(*range.frame(i));
        for (const auto* traversal : algorithms()) {
            SCOPED_TRACE(fmt::format("{} {}", scene.key, traversal->name()));
            expect_none_missed(*traversal, scene, frames, {{"contact_rule", "none"}});
        }
    };
    for (const std::string family : {"zero-volume", "collapsing:difficulty=4,pairs=64,together=64"})
        run(make_scene("hard:" + family));
    EXPECT_GT(flat, 20u);
    EXPECT_GT(met_, 100u);
    for (int corner = 0; corner < 8; ++corner)
        run(make_scene(fmt::format("hard:not-finite:pairs=9,together=9,difficulty={}", corner)));
    EXPECT_EQ(skipped, 72u);
}

/// Capacities one too small, exact and one too large: counts are complete, and a frame that does not fit runs
/// again.
TEST_P(HardAlgorithms, ExactCapacityLosesNothing) {
    const auto scene = make_scene("hard:exact-capacity:difficulty=1000");
    const auto frame = scene.frame(0);
    for (const auto* traversal : walks())
        for (const auto& [capacity, retries] : {std::pair{"999", 1u}, {"1000", 0u}, {"1001", 0u}}) {
            const auto session = prepare_on(on, *traversal, scene, {{"pair_capacity", capacity}});
            const auto result = run_among_all(*session, scene, frame);
            EXPECT_EQ(result.count, 1000u) << traversal->name() << " " << capacity;
            EXPECT_EQ(result.retries, retries) << traversal->name() << " " << capacity;
            EXPECT_EQ(result.download().size(), 1000u);
        }
}

/// Equal counts for every output mode. `adversarial --counter 32` goes past 2^32.
TEST_P(HardAlgorithms, CountsEqualTheConstruction) {
    const auto& family = hard_family("counter-wrap");
    const auto scene = make_scene("hard:counter-wrap:difficulty=15");
    for (const auto* traversal : walks())
        for (const std::string output : {"pairs", "count", "digest"}) {
            const auto session = prepare_on(on, *traversal, scene, {{"output", output}});
            const auto result = run_among_all(*session, scene, scene.frame(0));
            EXPECT_EQ(result.count, family.meeting(15)) << traversal->name() << " " << output;
        }
}

/// After many refits, a body has the bounds of a direct refit.
TEST_P(HardAlgorithms, RefitsDoNotDependOnEarlierFrames) {
    const auto scene = make_scene("hard:refit-order:difficulty=20");
    for (const auto* traversal : algorithms()) {
        const auto settings = resolved(*traversal);
        const auto old = prepare_on(on, *traversal, scene, settings);
        for (std::size_t i = 0; i + 1 < scene.frame_count; ++i) run_among_all(*old, scene, scene.frame(i));
        const auto last = scene.frame(scene.frame_count - 1);
        const auto result = run_among_all(*old, scene, last);
        const auto fresh = prepare_on(on, *traversal, scene, settings);
        const auto expected = run_among_all(*fresh, scene, last);
        EXPECT_GT(expected.count, 0u);
        EXPECT_EQ(result.digest(), expected.digest()) << traversal->name();
    }
}

bool is_finite(const ContactPoint& contact) {
    double sum = contact.depth;
    for (unsigned axis = 0; axis < 3; ++axis) sum += contact.point[axis] + contact.normal[axis];
    return std::isfinite(sum);
}

/// Divisions by tiny values still give finite numbers, and contacts exist.
TEST_P(HardAlgorithms, ContactsAreFinite) {
    const auto& traversal = algorithm("chunked");
    std::size_t found = 0;
    for (const auto& family : hard_families()) {
        if (family.name == "not-finite") continue;
        const auto scene = make_scene(specification(family));
        const auto session =
            prepare_on(on, traversal, scene, {{"pair_capacity", "32768"}, {"contact_capacity", "65536"}});
        const auto result = run_among_all(*session, scene, scene.frame(0));
        for (const auto& contact : result.download_contacts()) {
            ASSERT_TRUE(is_finite(contact)) << family.name;
            ++found;
        }
    }
    EXPECT_GT(found, 10000u);
}

TANDEM_ON_DEVICES(HardAlgorithms);

} // namespace
} // namespace tandem
