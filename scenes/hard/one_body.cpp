// SPDX-License-Identifier: MIT
// Group g: pairs of tetrahedra of one body. They share no vertex number, but may share positions.
#include "scenes/hard/families.h"
#include "scenes/hard/maker.h"
#include "scenes/hard/solids.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace tandem::hard {

namespace {

using Vector = Eigen::Vector3d;

double as_float(double x) { return static_cast<double>(static_cast<float>(x)); }

Vector as_floats(const Vector& v) { return {as_float(v.x()), as_float(v.y()), as_float(v.z())}; }

/// A random multiple of 1/64 up to `reach` of them, which is exact beside integers.
double jitter(Random& random, int reach) { return whole(random, -reach, reach) / 64.0; }

/// One frame of deformable bodies, each with the vertices of its mesh.
Scene deformed(std::vector<Mesh> meshes) {
    Scene scene;
    Frame frame;
    for (auto& mesh : meshes) {
        for (auto& v : mesh.vertices) v = as_floats(v);
        complete_mesh(mesh, mesh.name);
        scene.bodies.push_back({.mesh = static_cast<std::uint32_t>(scene.bodies.size()), .deformable = true});
        frame.deformed.push_back(mesh.vertices);
    }
    frame.poses.resize(meshes.size());
    scene.meshes = std::move(meshes);
    scene.frame = [frame = std::move(frame)](std::size_t) { return frame; };
    return scene;
}

Mesh moved_by(Mesh mesh, const Vector& by) {
    for (auto& v : mesh.vertices) v += by;
    return mesh;
}

/// Pairs of tetrahedra without a common vertex number, but with a common position. Where equal positions make
/// a mesh without overlaps, these are all pairs that meet.
std::uint64_t pairs_of_equal_positions(const Mesh& mesh) {
    std::map<std::array<double, 3>, std::uint32_t> numbers;
    std::vector<std::uint32_t> place;
    for (const auto& v : mesh.vertices)
        place.push_back(
            numbers.emplace(std::array{v.x(), v.y(), v.z()}, static_cast<std::uint32_t>(numbers.size()))
                .first->second);
    const auto have_common = [](const Tetrahedron& t, const Tetrahedron& u) {
        return std::ranges::any_of(t, [&](auto vertex) { return std::ranges::find(u, vertex) != u.end(); });
    };
    const auto at_places = [&](Tetrahedron t) {
        for (auto& vertex : t) vertex = place[vertex];
        return t;
    };
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const auto &t = mesh.tetrahedra[i], &u = mesh.tetrahedra[j];
            count += !have_common(t, u) && have_common(at_places(t), at_places(u)) ? 1 : 0;
        }
    return count;
}

/// A box of cells, cut at x = 0 into halves with their own vertices. The right half begins at x = gap.
Mesh cut_box(Random& random, double gap) {
    auto mesh = grid({4, 2, 2}, {4, 2, 2});
    for (auto& v : mesh.vertices)
        for (int axis = 0; axis < 3; ++axis)
            if (axis > 0 || v.x() != 0) v[axis] += jitter(random, 4);
    std::map<std::uint32_t, std::uint32_t> copies;
    for (auto& tetrahedron : mesh.tetrahedra) {
        double sum = 0;
        for (const auto vertex : tetrahedron) sum += mesh.vertices[vertex].x();
        if (sum < 0) continue;
        for (auto& vertex : tetrahedron) {
            if (mesh.vertices[vertex].x() != 0 && !copies.contains(vertex)) continue;
            const auto next = static_cast<std::uint32_t>(mesh.vertices.size());
            const auto [copy, added] = copies.emplace(vertex, next);
            if (added) mesh.vertices.push_back(mesh.vertices[vertex]);
            vertex = copy->second;
        }
    }
    for (const auto& [vertex, copy] : copies) mesh.vertices[copy].x() = gap;
    return mesh;
}

/// 10^-digits, by operations that round equally on every machine.
double negative_power_of_ten(double digits) {
    double power = 1;
    for (int i = 0; i < static_cast<int>(digits); ++i) power *= 10;
    return 1 / power;
}

/// Body 0 has halves 10^-digits apart, body 1 halves that touch at vertices of equal positions.
Scene nearly_shared(Random& random, double digits) {
    return deformed(
        {cut_box(random, negative_power_of_ten(digits)), moved_by(cut_box(random, 0), {0, 8, 0})});
}

std::uint64_t nearly_shared_meeting(double) {
    Random random(0);
    return pairs_of_equal_positions(cut_box(random, 0));
}

/// A sheet of thickness 1/2 that is folded about the y axis. Its lower layer is z = -1/2..0, its upper one
/// z = gap..gap + 1/2, both at x < 0; column 4 is the bend.
Mesh folded(Random& random, double gap) {
    auto mesh = grid({8, 2, 1}, {8, 2, 1});
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
        const auto column = static_cast<int>(i % 9);
        const bool inner = i >= mesh.vertices.size() / 2, upper = column > 4;
        const double y = mesh.vertices[i].y();
        if (column == 4) {
            mesh.vertices[i] = {inner ? 0.5 : 1, y, gap / 2};
            continue;
        }
        const double x = std::abs(column - 4) - 1;
        mesh.vertices[i] = {-x + jitter(random, 4), y + jitter(random, 4),
                            upper ? gap + (inner ? 0 : 0.5) : (inner ? 0 : -0.5)};
    }
    return mesh;
}

/// Body 0 has layers 10^-digits apart, body 1 layers that touch.
Scene folded_flat(Random& random, double digits) {
    return deformed({folded(random, negative_power_of_ten(digits)), moved_by(folded(random, 0), {0, 8, 0})});
}

/// A box of unit cells in which eight vertices are somewhere else, so that their elements invert and reach
/// into elements that share no vertex with them.
Scene inverted_elements(Random& random, double cells) {
    auto mesh = grid({4, 4, 3}, {4, 4, 3});
    for (int i = 0; i < 8; ++i) {
        auto& v = mesh.vertices[random.next() % mesh.vertices.size()];
        v += cells * random.direction();
    }
    return deformed({mesh});
}

/// A bar wound into three square turns whose upper faces have the shape of the next turn's lower faces.
Mesh coil(Random& random, double gap) {
    constexpr std::uint32_t columns = 8, turns = 3;
    constexpr double around[columns][2] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                           {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
    auto mesh = grid({columns * turns, 1, 1}, {1, 1, 1});
    const double radius[2] = {1 + jitter(random, 8), 2 + jitter(random, 8)};
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
        const auto column = i % (columns * turns + 1), side = i / (columns * turns + 1);
        const auto* direction = around[column % columns];
        const double r = radius[side % 2];
        const double bottom = 1.0 * column / columns + column / columns * gap;
        mesh.vertices[i] = {r * direction[0], r * direction[1], bottom + side / 2};
    }
    return mesh;
}

/// Body 0 has turns 10^-digits apart, body 1 turns that touch.
Scene coils(Random& random, double digits) {
    return deformed({coil(random, negative_power_of_ten(digits)), moved_by(coil(random, 0), {0, 8, 0})});
}

std::uint64_t coils_meeting(double) {
    Random random(0);
    return pairs_of_equal_positions(coil(random, 0));
}

constexpr std::uint32_t wedge_count = 12;

/// Thin wedges around one edge, each with its own vertices.
Scene wedges(Random& random, double digits) {
    const double thin = negative_power_of_ten(digits);
    std::vector<FloatCorners> all;
    for (std::uint32_t i = 0; i < wedge_count; ++i) {
        const double x = 1 + random.uniform(), y = 2 * i * thin;
        const Corners corners{Vector{0, 0, -1}, Vector{0, 0, 1}, Vector{x, x * y, -0.25},
                              Vector{x, x * (y + thin), 0.25}};
        auto& wedge = all.emplace_back();
        for (unsigned c = 0; c < 4; ++c)
            for (int axis = 0; axis < 3; ++axis)
                wedge[c][static_cast<unsigned>(axis)] = static_cast<float>(corners[c][axis]);
    }
    return deformed({separate("wedges", all)});
}

std::uint64_t wedges_meeting(double) { return wedge_count * (wedge_count - 1) / 2; }

constexpr HardFamily one_body_table[] = {
    {.row = 44,
     .group = 'g',
     .name = "nearly-shared",
     .summary = "a cut box whose halves have different vertices at equal or nearly equal positions",
     .knob = {"decimal digits of the distance, negated", 1, 30, 6},
     .truth = HardTruth::construction,
     .metric = "FPR with self=on",
     .fails = "rules that leave out pairs by positions, or vertices merged by a tolerance",
     .scene = nearly_shared,
     .meeting = nearly_shared_meeting,
     .self = true},
    {.row = 45,
     .group = 'g',
     .name = "folded-flat",
     .summary = "a sheet that is folded flat onto itself",
     .knob = {"decimal digits of the distance of layers, negated", 1, 30, 5},
     .truth = HardTruth::oracle,
     .metric = "FPR with self=on",
     .fails = "tolerances; axes of parallel faces",
     .scene = folded_flat,
     .self = true},
    {.row = 46,
     .group = 'g',
     .name = "inverted-elements",
     .summary = "a box with vertices so far off that elements invert and reach into others",
     .knob = {"displacement in cells", 0.25, 4, 2},
     .truth = HardTruth::oracle,
     .metric = "MISS with self=on",
     .fails = "normals and signs of volume that trust the orientation",
     .scene = inverted_elements,
     .self = true},
    {.row = 47,
     .group = 'g',
     .name = "coil",
     .summary = "a bar wound into turns that touch",
     .knob = {"decimal digits of the distance of turns, negated", 1, 6, 5},
     .truth = HardTruth::construction,
     .metric = "FPR with self=on",
     .fails = "tolerances; rules that leave out neighbours by distance along the body",
     .scene = coils,
     .meeting = coils_meeting,
     .self = true},
    {.row = 48,
     .group = 'g',
     .name = "wedges",
     .summary = "thin wedges with their own vertices that touch along one edge",
     .knob = {"decimal digits of the thickness, negated", 1, 20, 4},
     .truth = HardTruth::construction,
     .metric = "MISS with self=on",
     .fails = "rules that leave out pairs by positions; axes left out for being short",
     .scene = wedges,
     .meeting = wedges_meeting,
     .self = true}};

} // namespace

std::span<const HardFamily> one_body_families() { return one_body_table; }

} // namespace tandem::hard
