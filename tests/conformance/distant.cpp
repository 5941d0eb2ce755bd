// SPDX-License-Identifier: MIT
// Meshes far from their own origin, which origin=auto centres: answers equal the reference, which centres by
// its own code, and contain what meets on arcs about the meshes' own origins.
#include "algorithms/bodies/origin.h"
#include "harness/verify/oracle/motion_truth.h"
#include "tests/support/frames_there.h"
#include "tests/support/limited.h"
#include "tests/support/long_form.h"
#include "tests/support/scenes.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using Vector = Eigen::Vector3d;

/// The reference of a session for frames that are relative to the world's origin.
ReferenceAnswer right_for(const Session& session, const Scene& scene, const FrameInput& input) {
    const auto frame = counted_from(session.origin(), input.frame);
    const auto next = input.next != nullptr ? counted_from(session.origin(), *input.next) : Frame();
    return reference(scene, {frame, input.next != nullptr ? &next : nullptr}, geometry_of(session.settings()),
                     true, Method::brute_force, contact_settings_of(session.settings()));
}

class DistantMeshes : public OnDevice {
protected:
    /// All algorithms; on other devices than the host, where compilation takes long, one of each hierarchy.
    static std::vector<const Traversal*> walks() {
        if (GetParam() != "host" && !long_form()) return {&algorithm("tiled"), &algorithm("chunked")};
        return {algorithms().begin(), algorithms().end()};
    }

    Scene scene_ = with_distant_meshes(crowd(11, 9, 2), {2e6, 3e4, 0});
    Frame frame_ = scene_.frame(0), next_ = scene_.frame(1);
};

TEST_P(DistantMeshes, GiveTheAnswerOfTheReference) {
    std::vector<SettingTexts> cells{{{"broad", "device"}}};
    if (walks().size() > 2) {
        cells.push_back({{"broad", "tight"}, {"k", "8"}, {"precision", "double"}});
        cells.push_back({{"broad", "sphere"}, {"placement", "exact"}, {"self", "deformable"}});
        cells.push_back({{"broad", "sphere_boxes"}, {"pair_layout", "items"}});
    }
    for (const auto* traversal : walks())
        for (auto given : cells) {
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            given["origin"] = "auto";
            const auto session = prepare_on(on, *traversal, scene_, given);
            for (const auto* frame : {&frame_, &next_}) {
                const auto right = right_for(*session, scene_, *frame);
                const auto result = session->run(*frame);
                EXPECT_GT(result.count, 1000u);
                expect_same_digests(result, right);
            }
        }
}

TEST_P(DistantMeshes, GiveTheAnswerOfTheReferenceInMotion) {
    std::vector<SettingTexts> cells{{{"broad", "device"}}};
    if (walks().size() > 2) {
        cells.push_back({{"broad", "tight"}, {"precision", "double"}});
        cells.push_back({{"broad", "sphere"}, {"placement", "exact"}});
    }
    // A second frame near the first, because arcs about distant origins are long.
    const auto nearly = Eigen::Quaterniond(Eigen::AngleAxisd(1e-3, Vector(1, 2, 3).normalized()));
    for (std::size_t body = 2; body < next_.poses.size(); ++body) {
        next_.poses[body] = frame_.poses[body];
        next_.poses[body].rotation = nearly * next_.poses[body].rotation;
    }
    for (const auto* traversal : walks())
        for (auto given : cells) {
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            for (const auto& [name, value] :
                 SettingTexts{{"origin", "auto"}, {"motion", "linear"}, {"contact_rule", "none"}})
                given[name] = value;
            const auto session = prepare_on(on, *traversal, scene_, given);
            const auto right = right_for(*session, scene_, {frame_, &next_});
            EXPECT_EQ(session->run({frame_, next_}).download(), right.pairs);
            if (given.contains("placement")) continue; // the host bounds drift
            const Rows rows(frame_, false), next_rows(next_, false);
            const auto on_device = rows.uploaded_to(on), next_on_device = next_rows.uploaded_to(on);
            EXPECT_EQ(session->run({on_device, next_on_device}).download(),
                      session->run({rows.host, next_rows.host}).download());
        }
}

/// An answer outlives its session, and the centred copy of the scene with it.
TEST_P(DistantMeshes, KeepTheirAnswers) {
    auto session = prepare_on(on, algorithm("tiled"), scene_, {{"origin", "auto"}});
    const auto pairs = session->run(frame_).download();
    const auto result = session->run(frame_);
    session.reset();
    EXPECT_EQ(result.download(), pairs);
    EXPECT_EQ(result.download_contacts().size(), result.contacts);
}

/// A body turns about the distant origin of its mesh by `angle`, and another waits on the way.
struct OnTheArc {
    OnTheArc(Random& random, double distance, double angle) {
        const Vector arm = distance * random.direction();
        auto mesh = one_tetrahedron(1);
        for (auto& v : mesh.vertices) v += arm;
        scene.name = scene.key = "arc";
        scene.meshes = {mesh, one_tetrahedron(1)};
        scene.bodies = {{.mesh = 0}, {.mesh = 1}};
        const Vector axis = random.direction();
        const auto at = [&](double s) {
            const auto turn = Eigen::Quaterniond(Eigen::AngleAxisd(s * angle, axis));
            return Pose{turn, s * Vector(3, 2, 1) - arm};
        };
        const auto middle = at(random.uniform(0.4, 0.6));
        const Pose waits{Eigen::Quaterniond::Identity(),
                         middle.rotation * (arm + Vector(0.2, 0.2, 0.2)) + middle.translation};
        from = {{at(0), waits}, std::vector<std::vector<Vector>>(2)};
        to = {{at(1), waits}, std::vector<std::vector<Vector>>(2)};
        scene.frame = [frame = from](std::size_t) { return frame; };
    }
    Scene scene;
    Frame from, to;
};

/// The path of the shifted centre is an arc: slabs without it would miss what meets there.
TEST_P(DistantMeshes, MissNothingOnArcsAboutTheirOrigins) {
    Random random(31);
    std::uint64_t met = 0;
    for (int i = 0; i < 24; ++i) {
        const double distance = std::pow(10, 1.5 + 0.2 * i);
        const OnTheArc arc(random, distance, std::sqrt(200 / distance)); // leaves the chord by 25
        for (const auto* traversal : walks())
            for (const std::string broad : {"device", "tight", "sphere"}) {
                if (walks().size() == 2 && broad != (traversal->name() == "tiled" ? "device" : "tight"))
                    continue;
                SCOPED_TRACE(std::string(traversal->name()) + " " + broad + " " + std::to_string(distance));
                const auto session = prepare_on(
                    on, *traversal, arc.scene,
                    {{"origin", "auto"}, {"motion", "linear"}, {"contact_rule", "none"}, {"broad", broad}});
                const auto truth = motion_truth(arc.scene, counted_from(session->origin(), arc.from),
                                                counted_from(session->origin(), arc.to),
                                                {Precision::fp32, Placement::rounded, Origin::automatic});
                met += truth.colliding.size();
                const auto found = session->run({arc.from, arc.to}).download();
                EXPECT_TRUE(std::ranges::includes(found, truth.colliding));
            }
    }
    EXPECT_GT(met, 40u);
}

TANDEM_ON_DEVICES(DistantMeshes);

/// Two devices share the bodies, whose arcs exceed the skins of the first partition.
TEST(SharedDistantMeshes, GiveTheAnswerOfTheReference) {
    const auto scene = with_distant_meshes(procession(24, 4, 0.35), {1e5});
    const std::array devices{&device("host"), &device("opencl:0")};
    for (const std::string broad : {"device", "tight"}) {
        const auto& tiled = algorithm("tiled");
        const auto session =
            tiled.prepare(devices, scene, resolved(tiled, {{"broad", broad}, {"origin", "auto"}}));
        for (const std::size_t i : {0u, 1u, 3u}) {
            const auto right = right_for(*session, scene, scene.frame(i));
            const auto result = session->run(scene.frame(i));
            EXPECT_GT(result.count, 500u);
            expect_same_digests(result, right);
        }
    }
}

} // namespace
} // namespace tandem
