// SPDX-License-Identifier: MIT
// Families of hard cases as scenes.
#include "base/error.h"
#include "scenes/hard/hard.h"
#include "scenes/hard/solids.h"
#include "scenes/parameters.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tandem {

namespace {

using Vertices = std::vector<Eigen::Vector3d>;

void append(Vertices& vertices, const FloatCorners& corners) {
    for (const auto& c : corners)
        vertices.emplace_back(static_cast<double>(c[0]), static_cast<double>(c[1]),
                              static_cast<double>(c[2]));
}

/// Vertices of both bodies for pairs first..first + together - 1.
std::vector<Vertices> pair_vertices(const HardFamily& family, std::uint64_t seed, double difficulty,
                                    std::uint64_t first, std::uint64_t together) {
    std::vector<Vertices> bodies(2);
    for (std::uint64_t i = first; i < first + together; ++i) {
        const auto pair = hard_pair(family, seed, i, difficulty);
        append(bodies[0], pair.a);
        append(bodies[1], pair.b);
    }
    return bodies;
}

/// One mesh of separate tetrahedra, four vertices each.
Mesh pair_mesh(Vertices vertices) {
    Mesh mesh;
    mesh.name = "hard";
    for (auto& v : vertices)
        if (!v.allFinite()) v.setZero(); // a mesh must be finite; frames need not
    mesh.vertices = std::move(vertices);
    for (std::uint32_t first = 0; first < mesh.vertices.size(); first += 4)
        mesh.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
    complete_mesh(mesh, mesh.name);
    return mesh;
}

/// A frame depends only on its number, so that frames can be made in any order. Families are constant tables,
/// which outlive every scene.
std::function<Frame(std::size_t)> pair_frames(const HardFamily& family, std::uint64_t seed, double difficulty,
                                              std::uint64_t together) {
    if (family.pose != nullptr)
        return [&family, seed, difficulty](std::size_t index) {
            Random random(seed + 0x9e3779b97f4a7c15u * (index + 1));
            const auto pose = family.pose(random, difficulty);
            return Frame{{pose, pose}, std::vector<Vertices>(2)};
        };
    return [&family, seed, difficulty, together](std::size_t index) {
        return Frame{std::vector<Pose>(2),
                     pair_vertices(family, seed, difficulty, index * together, together)};
    };
}

double difficulty_of(const HardFamily& family, std::span<const SceneParameter> parameters) {
    const double difficulty = real_parameter(parameters, "difficulty", -1e300, 1e300);
    check_difficulty(family, difficulty);
    return difficulty;
}

/// Gives each mesh a random pressure field above 0. A field of distances from the surface would be 0 in
/// separate tetrahedra, which have no vertex inside.
void add_fields(Scene& scene, std::uint64_t seed) {
    Random random(seed);
    for (auto& mesh : scene.meshes) {
        mesh.pressures.resize(mesh.vertices.size());
        for (double& pressure : mesh.pressures) pressure = 1 - random.uniform();
    }
}

Scene make_without_fields(const HardFamily& family, double difficulty, std::uint64_t seed,
                          std::span<const SceneParameter> parameters) {
    if (family.scene != nullptr) {
        Random random(seed);
        return family.scene(random, difficulty);
    }
    return hard_pair_scene(family, seed, difficulty,
                           {integer_parameter(parameters, "pairs", 1, 1000000),
                            integer_parameter(parameters, "together", 1, 1000000)});
}

Scene make_kind(const HardFamily& family, std::span<const SceneParameter> parameters) {
    const auto seed = integer_parameter(parameters, "seed", 0, ~std::uint64_t{0});
    auto scene = make_without_fields(family, difficulty_of(family, parameters), seed, parameters);
    if (integer_parameter(parameters, "field", 0, 1) != 0) add_fields(scene, seed);
    return scene;
}

SceneKind kind_of(const HardFamily& family) {
    SceneKind kind;
    kind.name = fmt::format("hard:{}", family.name);
    kind.models = family.summary;
    kind.parameters.push_back(
        {"difficulty", fmt::format("{}", family.knob.initial),
         fmt::format("{}, {}..{}", family.knob.meaning, family.knob.least, family.knob.most)});
    kind.parameters.push_back({"seed", "1", "seed of all random numbers"});
    kind.parameters.push_back(
        {"field", "0", "1: random pressures above 0 at all vertices, for contact_rule=pressure", "0"});
    if (family.scene == nullptr) {
        kind.parameters.push_back({"pairs", "64", "number of pairs, `together` in a frame"});
        kind.parameters.push_back(
            {"together", "16", "pairs in a frame, which can also overlap each other; divides pairs"});
    }
    kind.make = [&family](std::span<const SceneParameter> parameters) {
        return make_kind(family, parameters);
    };
    return kind;
}

/// The items of "hard:all:..." that a family accepts.
std::string accepted(const HardFamily& family, std::string_view items) {
    std::string result;
    while (!items.empty()) {
        const auto item = items.substr(0, items.find(','));
        items.remove_prefix(std::min(items.size(), item.size() + 1));
        const auto name = item.substr(0, item.find('='));
        if (name != "seed" && name != "field" && name != "pairs" && name != "together")
            throw InputError(fmt::format(
                "hard:all accepts seed, field, pairs and together, not '{}'; name one family", name));
        if (name == "seed" || name == "field" || family.scene == nullptr)
            result += fmt::format("{}{}", result.empty() ? "" : ",", item);
    }
    return result;
}

} // namespace

Scene hard_pair_scene(const HardFamily& family, std::uint64_t seed, double difficulty, HardCount count) {
    if (count.pairs % count.together != 0)
        throw InputError(fmt::format("hard:{}: together={} does not divide pairs={}", family.name,
                                     count.together, count.pairs));
    Scene scene;
    const bool rigid = family.pose != nullptr;
    for (auto& vertices : pair_vertices(family, seed, difficulty, 0, count.together))
        scene.meshes.push_back(pair_mesh(std::move(vertices)));
    scene.bodies = {{.mesh = 0, .deformable = !rigid}, {.mesh = 1, .deformable = !rigid}};
    scene.frame_count = count.pairs / count.together;
    scene.frame = pair_frames(family, seed, difficulty, count.together);
    return scene;
}

std::span<const SceneKind> hard_kinds() {
    static const auto kinds = [] {
        std::vector<SceneKind> all;
        for (const auto& family : hard_families()) all.push_back(kind_of(family));
        return all;
    }();
    return kinds;
}

std::vector<std::string> expand_hard(const std::string& specification) {
    constexpr std::string_view all = "hard:all";
    if (!specification.starts_with(all)) return {specification};
    if (specification.size() > all.size() && specification[all.size()] != ':') return {specification};
    const auto items = std::string_view(specification).substr(std::min(specification.size(), all.size() + 1));
    std::vector<std::string> result;
    for (const auto& family : hard_families()) {
        const auto family_items = accepted(family, items);
        result.push_back(
            fmt::format("hard:{}{}{}", family.name, family_items.empty() ? "" : ":", family_items));
    }
    return result;
}

} // namespace tandem
