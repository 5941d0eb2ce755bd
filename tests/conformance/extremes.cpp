// SPDX-License-Identifier: MIT
// Scenes in which everything touches without overlapping, and scenes in which everything overlaps. Random
// crowds almost never contain either.
#include "tests/support/cells.h"
#include "tests/support/long_form.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

Scene still(Mesh mesh, std::vector<Pose> poses) {
    Scene scene;
    scene.name = scene.key = mesh.name;
    scene.meshes = {std::move(mesh)};
    for (std::size_t i = 0; i < poses.size(); ++i) scene.bodies.push_back({});
    scene.frame_count = 1;
    scene.frame = [poses](std::size_t) {
        Frame frame;
        frame.poses = poses;
        frame.deformed.resize(poses.size());
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// Two adjacent boxes whose faces touch; every number is exact in float.
Scene touching() {
    Random random(1);
    auto mesh = shaken_box(2, random);
    for (auto& v : mesh.vertices) v = (v * 2).array().round() / 2; // back to the lattice
    complete_mesh(mesh, "touching");
    mesh.name = "touching";
    Pose shifted;
    shifted.translation = {1, 0, 0};
    return still(mesh, {Pose{}, shifted});
}

constexpr std::uint32_t crossing = 128;

/// Tetrahedra of one size around one point, so each overlaps every other.
Scene all_overlapping() {
    Random random(2);
    Mesh mesh;
    for (std::uint32_t i = 0; i < crossing; ++i) {
        const auto rotation = random.rotation();
        for (const auto& corner : {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, -1, -1),
                                   Eigen::Vector3d(-1, 1, -1), Eigen::Vector3d(-1, -1, 1)})
            mesh.vertices.emplace_back(rotation * corner);
        mesh.tetrahedra.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
    }
    complete_mesh(mesh, "overlapping");
    mesh.name = "overlapping";
    return still(mesh, std::vector<Pose>(3));
}

/// Every algorithm and schedule with several group sizes, on every device. The short form uses one group
/// size, `only`, on devices that compile kernels.
void expect_everywhere(const Scene& scene, std::uint64_t at_least, std::string_view only) {
    const auto frame = scene.frame(0);
    const auto expected = reference(scene, frame, {}, false, Method::brute_force);
    EXPECT_GE(expected.digest.count, at_least);
    std::uint64_t cells = 0;
    for (const auto& backend : discover()) {
        for (const auto& on : backend.devices) {
            for (const std::string group : {"1", "8", "64"}) {
                if (!long_form() && on->info().id != "host" && group != only) continue;
                for (const auto* traversal : algorithms()) {
                    std::vector<SettingTexts> all{{{"group_size", group}, {"work_items", "64"}}};
                    if (traversal->name() == "chunked") {
                        all.push_back(all.front());
                        all.back()["schedule"] = "item";
                        all.insert(all.end(), 2, all.front());
                        all[2]["descent"] = all[3]["descent"] = "both";
                        all[3]["schedule"] = "item";
                        for (auto& settings : all) settings["leaves"] = "32";
                    }
                    if (!long_form() && on->info().id != "host" && all.size() > 1)
                        all.erase(all.begin() + 1, all.end() - 1);
                    for (const auto& given : all) {
                        SCOPED_TRACE(
                            fmt::format("{} on {}:{}", traversal->name(), on->info().id, text(given)));
                        const auto session = prepare_on(*on, *traversal, scene, given);
                        const auto result = session->run(frame, all_pairs(scene));
                        EXPECT_EQ(result.digest(), expected.digest);
                        on->finish();
                        ++cells;
                    }
                }
            }
        }
    }
    EXPECT_GE(cells, 18u);
    fmt::print("{} candidate pairs in each of {} cells\n", expected.digest.count, cells);
}

TEST(Extremes, TouchingOverlapsOnlyLong) { expect_everywhere(touching(), 48, "64"); }

TEST(Extremes, EverythingOverlapsLong) {
    expect_everywhere(all_overlapping(), 3ull * crossing * crossing, "8");
}

} // namespace
} // namespace tandem
