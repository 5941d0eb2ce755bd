// SPDX-License-Identifier: MIT
// Contact rules and decisions through sessions, on stones that touch: buffers and schedules of both
// algorithms.
#include "algorithms/narrow_phase/contact_settings.h"
#include "harness/verify/oracle/frame_truth.h"
#include "scenes/builtin.h"
#include "tests/support/on_device.h"
#include "tests/support/oracle_nested.h"
#include "tests/support/oracle_pairs.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

/// A frame of bodies with one tetrahedron each.
Scene bodies_of(const std::string& name, const std::vector<TetraCorners>& tetrahedra) {
    Scene scene;
    scene.name = scene.key = name;
    for (const auto& corners : tetrahedra) {
        Mesh mesh;
        mesh.name = "one";
        for (const auto& p : corners) mesh.vertices.push_back({p[0], p[1], p[2]});
        mesh.tetrahedra = {{0, 1, 2, 3}};
        complete_mesh(mesh, "one");
        scene.bodies.push_back({.mesh = static_cast<std::uint32_t>(scene.meshes.size())});
        scene.meshes.push_back(mesh);
    }
    scene.frame_count = 1;
    scene.frame = [bodies = tetrahedra.size()](std::size_t) {
        Frame frame;
        frame.poses.resize(bodies);
        frame.deformed.resize(bodies);
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// Coordinates spread over thirty powers of ten: not even double can decide many of the pairs.
Scene hard_pairs(std::size_t bodies) {
    Random random(8);
    std::vector<TetraCorners> tetrahedra;
    while (tetrahedra.size() < bodies) tetrahedra.push_back(random_pair(Family::mixed_exponents, random).a);
    return bodies_of("hard pairs", tetrahedra);
}

/// Three pairs per kind of nesting, and all other pairs that these make.
Scene nested_pairs() {
    NestedMaker maker(9);
    std::vector<TetraCorners> tetrahedra;
    for (unsigned i = 0; i < 3 * static_cast<unsigned>(Nesting::count); ++i) {
        const auto [a, b] = maker.make(static_cast<Nesting>(i % static_cast<unsigned>(Nesting::count)));
        tetrahedra.insert(tetrahedra.end(), {a, b});
    }
    return bodies_of("nested pairs", tetrahedra);
}

class ContactConformance : public OnDevice {
protected:
    Scene scene = make_scene("colosseum:slices=3,layers=1");
    Frame frame = scene.frame(0);

    std::unique_ptr<Session> prepare(const std::string& algorithm_name, const SettingTexts& given) const {
        const auto& traversal = algorithm(algorithm_name);
        return prepare_on(on, traversal, scene, given);
    }

    /// Runs the frame and compares it with the reference.
    FrameResult expect_right(const std::string& algorithm_name, const SettingTexts& given) {
        SCOPED_TRACE(algorithm_name + " on " + on.info().id + text(given));
        const auto session = prepare(algorithm_name, given);
        const auto& settings = session->settings();
        const auto expected = reference(scene, frame, geometry_of(settings), true, Method::brute_force,
                                        contact_settings_of(settings));
        const auto result = run_among_all(*session, scene, frame);
        EXPECT_EQ(result.contact_digest(), expected.contact_digest);
        EXPECT_EQ(result.without_boundary, expected.without_boundary);
        EXPECT_EQ(result.rejected, expected.rejected);
        EXPECT_EQ(result.degenerate, expected.degenerate);
        EXPECT_EQ(result.undecided_by_filter, expected.undecided_by_filter);
        EXPECT_EQ(result.undecided_by_double, expected.undecided_by_double);
        EXPECT_GT(result.contacts, 0u);
        return result;
    }
};

TEST_P(ContactConformance, EveryDecisionEqualsTheReferenceInEveryResidency) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    EXPECT_EQ(expect_right("chunked", {}).undecided_by_filter, 0u);
    const auto recheck = expect_right("chunked", {{"decision", "recheck"}, {"contact_rule", "sat"}});
    EXPECT_GT(recheck.undecided_by_double, 100u);
    EXPECT_LE(recheck.undecided_by_double, recheck.undecided_by_filter);
    expect_right("gproximity", {{"decision", "fp64"}, {"contact_rule", "clip"}});
    const auto exact = expect_right(
        "gproximity", texts("decision=exact contact_rule=published pair_capacity=1 contact_capacity=1"));
    EXPECT_GT(exact.retries, 0u);
    expect_right("chunked", {{"decision", "exact"}, {"precision", "double"}});
    for (const std::string decision : {"recheck", "exact"})
        expect_right("chunked",
                     texts("contact_rule=sat residency=published seed_threshold=1 decision=" + decision));
    const auto all = expect_right("chunked", {{"decision", "none"}, {"contact_rule", "published"}});
    EXPECT_EQ(all.rejected, 0u);
    const SettingTexts rejecting{{"contact_rule", "published"}, {"residency", "published"}};
    EXPECT_GE(all.contacts, expect_right("gproximity", rejecting).contacts);
}

TEST_P(ContactConformance, RulesThatUseTheBoundaryEqualTheReference) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto sat = expect_right("chunked", {{"contact_rule", "sat"}});
    const auto restricted = expect_right("gproximity", {{"contact_rule", "restricted"}});
    EXPECT_EQ(restricted.contacts, sat.contacts); // every tetrahedron of a stone has boundary faces
    const auto vertex = expect_right("chunked", {{"contact_rule", "vertex"}, {"decision", "recheck"}});
    EXPECT_LT(vertex.contacts, restricted.contacts);
    expect_right("gproximity",
                 {{"contact_rule", "consistent"}, {"precision", "double"}, {"contact_capacity", "1"}});
    expect_right("chunked", {{"contact_rule", "growth"}, {"residency", "published"}});
}

TEST_P(ContactConformance, NestedPairsEqualTheReference) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    scene = nested_pairs();
    frame = scene.frame(0);
    for (const std::string rule : {"sat", "clip", "growth"})
        for (const std::string precision : {"float", "double"})
            expect_right("chunked", {{"contact_rule", rule}, {"precision", precision}});
}

TEST_P(ContactConformance, ExactRejectsTheDisjointPairsOfTheOracle) {
    const auto session = prepare("chunked", {{"decision", "exact"}});
    const auto result = run_among_all(*session, scene, frame);
    const auto truth = decide_pairs(scene, frame, Precision::fp32, result.download());
    const auto disjoint = std::count_if(
        truth.begin(), truth.end(), [](auto decision) { return decision.relation == Relation::disjoint; });
    EXPECT_EQ(result.rejected, static_cast<std::uint64_t>(disjoint));
    EXPECT_GT(disjoint, 0);
}

TEST_P(ContactConformance, ExactDecidesWhatDoubleCannot) {
    scene = hard_pairs(60);
    frame = scene.frame(0);
    const auto expected = [&](const std::string& decision) {
        const auto session = prepare("chunked", {{"decision", decision}});
        const auto result = run_among_all(*session, scene, frame);
        const auto truth = decide_pairs(scene, frame, Precision::fp32, result.download());
        const auto disjoint = std::count_if(
            truth.begin(), truth.end(), [](auto decided) { return decided.relation == Relation::disjoint; });
        return std::pair(result.rejected, static_cast<std::uint64_t>(disjoint));
    };
    const auto [apart, disjoint] = expected("exact");
    EXPECT_EQ(apart, disjoint);
    const auto [apart_in_double, same] = expected("fp64");
    EXPECT_LT(apart_in_double + 20, same);
}

TEST_P(ContactConformance, OnlyExactWaitsForTheHost) {
    for (const std::string decision : {"recheck", "fp64", "exact"}) {
        const auto session = prepare("chunked", {{"decision", decision}});
        on.set_clocks(Clocks::on);
        run_among_all(*session, scene, frame);
        const auto trace = on.finish();
        on.set_clocks(Clocks::off);
        const auto waits =
            std::count_if(trace.events.begin(), trace.events.end(), [](const auto& e) { return e.blocked; });
        EXPECT_EQ(waits > 1, decision == "exact") << decision;
    }
}

TANDEM_ON_DEVICES(ContactConformance);

} // namespace
} // namespace tandem
