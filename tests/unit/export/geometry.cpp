// SPDX-License-Identifier: MIT
// The part of a scene that its geometry for pages contains, and the form of it.
#include "scenes/export/geometry.h"
#include "scenes/export/quantised.h"
#include "base/base64.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>

namespace tandem::exporting {
namespace {

using testing::HasSubstr;

GeometrySizes pile(std::size_t bodies, std::size_t frames) {
    return {.meshes = {{1000, 2000, bodies, 0}}, .bodies = bodies, .frames = frames};
}

std::vector<std::uint32_t> one_chunk(const Mesh& mesh) {
    return std::vector<std::uint32_t>(mesh.tetrahedra.size(), 7);
}

TEST(ExportGeometry, SmallScenesAreWhole) {
    const auto shown = cut(pile(10, 50), {});
    EXPECT_EQ(shown.boxed, std::vector{false});
    EXPECT_EQ(shown.bodies, 10u);
    EXPECT_EQ(shown.frames, 50u);
}

TEST(ExportGeometry, ManyBodiesBecomeBoxesThenFewer) {
    const GeometryBudget budget;
    const auto many = cut(pile(10'000, 3), budget);
    EXPECT_EQ(many.boxed, std::vector{true});
    EXPECT_EQ(many.bodies, 10'000u);
    const auto too_many = cut(pile(1'000'000, 3), budget);
    EXPECT_LT(too_many.bodies, 60'000u);
    EXPECT_GT(too_many.bodies, 10'000u);
    EXPECT_GE(too_many.frames, 1u);
}

TEST(ExportGeometry, TheLargestMeshBecomesBoxesFirst) {
    const GeometrySizes sizes{
        .meshes = {{100, 200, 1, 0}, {400'000, 800'000, 1, 0}}, .bodies = 2, .frames = 1};
    EXPECT_EQ(cut(sizes, {}).boxed, (std::vector{false, true}));
}

TEST(ExportGeometry, ContactsReduceTheNumberOfFrames) {
    auto sizes = pile(1000, 1000);
    const auto without = cut(sizes, {});
    sizes.contacts = true;
    const auto with = cut(sizes, {});
    EXPECT_LT(without.frames, 1000u);
    EXPECT_LT(with.frames, without.frames);
    EXPECT_EQ(without.contacts, 0u);
    EXPECT_GT(with.contacts, 0u);
}

TEST(ExportGeometry, EveryCutFitsItsBudget) {
    const GeometryBudget budget;
    for (const std::size_t bodies : {1u, 100u, 5'000u, 300'000u})
        for (const std::size_t deformable : {0u, 1u, 50u})
            for (const std::size_t frames : {1u, 10u, 100'000u}) {
                const GeometrySizes sizes{.meshes = {{2000, 4000, bodies, std::min(deformable, bodies)}},
                                          .bodies = bodies,
                                          .frames = frames,
                                          .contacts = true};
                const auto shown = cut(sizes, budget);
                const auto vertices = shown.boxed[0] ? 8 : 2000;
                const auto bytes = mesh_bytes(2000, 4000)
                                   + shown.frames
                                         * (shown.bodies * 14 + std::min(deformable, bodies) * vertices * 6
                                            + shown.contacts * 11);
                EXPECT_LE(bytes, budget.bytes + budget.bytes / 4)
                    << bodies << ' ' << deformable << ' ' << frames;
            }
}

TEST(ExportGeometry, PointsKeepTheirPositions) {
    const Quantised in(Eigen::AlignedBox3d(Eigen::Vector3d(-1, 0, 5), Eigen::Vector3d(1, 0, 9)));
    std::vector<std::uint16_t> numbers;
    in.add({-1, 0, 9}, numbers);
    in.add({0, 0, 6}, numbers);
    EXPECT_EQ(numbers, (std::vector<std::uint16_t>{0, 0, 65535, 32768, 0, 16384}));
}

TEST(ExportGeometry, NotesWhatIsOmitted) {
    const auto scene = make_scene("plates:frames=200");
    std::vector<std::size_t> frames(200);
    std::iota(frames.begin(), frames.end(), 0);
    const GeometryParts parts{.chunks = one_chunk};
    const auto whole = nlohmann::json::parse(geometry_json(scene, frames, parts));
    EXPECT_EQ(whole["frames"].size(), 200u);
    EXPECT_TRUE(whole["notes"].empty());
    const auto less = nlohmann::json::parse(geometry_json(scene, frames, parts, {.bytes = 80'000}));
    EXPECT_LT(less["frames"].size(), 200u);
    EXPECT_EQ(less["of_frames"], 200);
    EXPECT_EQ(less["frames"].front(), 0);
    EXPECT_EQ(less["frames"].back(), 199);
    EXPECT_EQ(less["poses"].size(), less["frames"].size());
    EXPECT_THAT(less["notes"].dump(), HasSubstr("of 200 frames are shown, evenly spaced"));
}

/// Every part of a frame has the form that the page reads: numbers of known sizes in base64.
TEST(ExportGeometry, PartsHaveTheirSizes) {
    const auto scene = make_scene("plates:frames=2");
    const GeometryParts parts{.chunks = one_chunk,
                              .contacts = [](const Frame&) { return std::vector<ContactPoint>(5); }};
    const auto json = nlohmann::json::parse(geometry_json(scene, std::array<std::size_t, 1>{1}, parts));
    const auto bytes = [](const nlohmann::json& text) {
        return base64::decode(text.get<std::string>(), text.get<std::string>().size())->size();
    };
    const auto& mesh = json["meshes"][0];
    EXPECT_EQ(bytes(mesh["chunks"]) * 3 * sizeof(std::uint16_t), bytes(mesh["triangles"]));
    EXPECT_EQ(bytes(mesh["points"]) % (3 * sizeof(std::uint16_t)), 0u);
    EXPECT_EQ(base64::decode(mesh["chunks"].get<std::string>(), 1), "\7");
    EXPECT_EQ(bytes(json["poses"][0]), scene.bodies.size() * 7 * sizeof(std::uint16_t));
    EXPECT_EQ(bytes(json["body_meshes"]), scene.bodies.size() * sizeof(std::uint32_t));
    EXPECT_EQ(bytes(json["contacts"][0]["points"]), 5 * 3 * sizeof(std::uint16_t));
    EXPECT_EQ(bytes(json["contacts"][0]["normals"]), 5 * 3u);
    EXPECT_EQ(bytes(json["contacts"][0]["depths"]), 5 * sizeof(std::uint16_t));
    EXPECT_EQ(json["contacts"][0]["found"], 5);
    EXPECT_FALSE(json.contains("times"));
}

/// Depths are parts of the deepest one of all frames. Contacts that touch or are apart have depth 0.
TEST(ExportGeometry, DepthsArePartsOfTheDeepest) {
    const auto scene = make_scene("plates:frames=2");
    std::size_t calls = 0;
    const GeometryParts parts{.chunks = one_chunk, .contacts = [&](const Frame&) {
                                  std::vector<ContactPoint> contacts(4);
                                  const double all[2][4] = {{-0.5, 0, 0.25, std::nan("")}, {-1, -2, 0, 0}};
                                  for (std::size_t i = 0; i < contacts.size(); ++i)
                                      contacts[i].depth = all[calls][i];
                                  ++calls;
                                  return contacts;
                              }};
    const auto json = nlohmann::json::parse(geometry_json(scene, std::array<std::size_t, 2>{0, 1}, parts));
    const auto depths = [&](std::size_t frame) {
        const auto text = json["contacts"][frame]["depths"].get<std::string>();
        const auto bytes = *base64::decode(text, text.size());
        std::vector<std::uint16_t> numbers(bytes.size() / sizeof(std::uint16_t));
        std::memcpy(numbers.data(), bytes.data(), bytes.size());
        return numbers;
    };
    EXPECT_EQ(json["deepest"], 2.0);
    EXPECT_EQ(depths(0), (std::vector<std::uint16_t>{16384, 0, 0, 65535}));
    EXPECT_EQ(depths(1), (std::vector<std::uint16_t>{32767, 65534, 0, 0}));
}

} // namespace
} // namespace tandem::exporting
