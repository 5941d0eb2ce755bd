// SPDX-License-Identifier: MIT
// Group d: errors of the point, the normal and the depth of a contact.
#include "scenes/hard/families.h"
#include "scenes/hard/maker.h"
#include "scenes/hard/solids.h"

#include <cmath>

namespace tandem::hard {

namespace {

using Vector = Eigen::Vector3d;

/// A tetrahedron with a face around the origin, perpendicular to `up`, and its tip at -height * up.
Corners under(Random& random, const Vector& up, double height) {
    const Vector u = across(random, up).normalized();
    const Vector v = up.cross(u);
    const double size = random.uniform(0.5, 1);
    return {size * u, size * (-0.5 * u + 0.8 * v), size * (-0.5 * u - 0.8 * v), -height * up};
}

/// Two such tetrahedra whose faces have the angle `tilt`. The second penetrates the first by `depth`.
std::pair<Corners, Corners> facing(Random& random, double tilt, double depth) {
    const Vector up = random.direction();
    const auto a = under(random, up, 1);
    const Vector side = across(random, up).normalized();
    const auto b = under(random, -(up + tilt * side).normalized(), 1);
    return {a, moved(b, -depth * up)};
}

HardPair opposing_faces(Random& random, double angle, std::uint64_t) {
    const auto [a, b] = facing(random, angle, 0.05);
    return rounded_pair(random, a, b, Known::overlapping);
}

/// Edges that cross at a right angle; one is `depth` below the other.
HardPair edge_crossing(Random& random, double depth, std::uint64_t) {
    const Vector up = random.direction();
    const Vector along = across(random, up).normalized();
    const Vector side = up.cross(along);
    const Corners a{along, -along, -up + 0.6 * side, -up - 0.6 * side};
    const Corners b{side, -side, up + 0.6 * along, up - 0.6 * along};
    const double factor = random.uniform(0.8, 1.2);
    return rounded_pair(random, a, moved(scaled(b, factor), -depth * up), Known::overlapping);
}

/// A corner of b on the line from the middle of a's face to the opposite corner.
HardPair deep(Random& random, double fraction, std::uint64_t) {
    const auto a = random_tetrahedron(random);
    const Vector foot = (a[0] + a[1] + a[2]) / 3;
    const Vector tip = foot + fraction * (a[3] - foot);
    const auto shape = random_tetrahedron(random);
    const Vector out = (foot - a[3]).normalized();
    Corners b{tip, tip, tip, tip};
    for (unsigned i = 1; i < 4; ++i) b[i] += 1.5 * out + 0.6 * shape[i];
    return rounded_pair(random, a, b, Known::overlapping);
}

/// Regular tetrahedra from the corners of a cube, equal or mirrored, so that many axes have equal depth.
HardPair ties(Random& random, double noise, std::uint64_t index) {
    const Corners cube{Vector{1, 1, 1}, Vector{1, -1, -1}, Vector{-1, 1, -1}, Vector{-1, -1, 1}};
    auto a = cube;
    auto b = index % 2 == 0 ? cube : scaled(cube, -1);
    for (auto* corners : {&a, &b})
        for (auto& c : *corners) c += noise * random.direction();
    return rounded_pair(random, a, b, Known::overlapping);
}

/// Depths of at most 2^-8, so that also very thin faces keep a common point.
HardPair vanishing_depth(Random& random, double halvings, std::uint64_t) {
    const auto [a, b] = touching_integers(random, 3, 3);
    return exact_pair(random, a, moved(b, {-std::ldexp(1.0, -static_cast<int>(halvings)), 0, 0}),
                      Known::overlapping);
}

/// An edge of b crosses a's face at a small angle.
HardPair plane_division(Random& random, double angle, std::uint64_t) {
    const Vector up = random.direction();
    const auto a = under(random, up, 1);
    const Vector along = across(random, up).normalized();
    const Vector side = up.cross(along);
    const Vector from = -0.5 * angle * up - 0.3 * along;
    const Corners b{from, from + 0.8 * (along + angle * up), from + up + 0.3 * side, from + up - 0.3 * side};
    return rounded_pair(random, a, b, Known::overlapping);
}

/// Shapes of Erleben's configurations about the origin, directed along +y.
Mesh spike() {
    return separate("spike",
                    {{{{0, 0.5F, 0}, {-0.25F, -0.5F, -0.25F}, {0.25F, -0.5F, -0.25F}, {0, -0.5F, 0.25F}}}});
}

Mesh wedge() {
    return separate("wedge", {{{{-0.5F, 0.5F, 0}, {0.5F, 0.5F, 0}, {0, -0.5F, 0.5F}, {0, -0.5F, -0.5F}}}});
}

/// A flat box with a gap of 0.25 in its middle: two boxes in one mesh.
Mesh cracked() {
    auto mesh = grid({2, 1, 2}, {1, 1, 2});
    const auto vertices = mesh.vertices;
    const auto tetrahedra = mesh.tetrahedra;
    const auto count = static_cast<std::uint32_t>(vertices.size());
    for (auto& v : mesh.vertices) v.x() -= 0.625;
    for (const auto& v : vertices) mesh.vertices.emplace_back(v.x() + 0.625, v.y(), v.z());
    for (auto t : tetrahedra) {
        for (auto& corner : t) corner += count;
        mesh.tetrahedra.push_back(t);
    }
    mesh.name = "cracked";
    complete_mesh(mesh, mesh.name);
    return mesh;
}

Pose upside_down(const Vector& translation) { return {Eigen::Quaterniond(0, 1, 0, 0), translation}; }

/// Erleben's configurations (2018, section 5: points, edges and faces of spikes, wedges and boxes) with depth
/// `depth`, 8 apart. Bodies 2i and 2i + 1 are configuration i.
Scene configurations(Random&, double depth) {
    const auto box = grid({2, 1, 2}, {2, 1, 2});
    Scene scene = still({spike(), wedge(), box, cracked()}, {});
    std::vector<Pose> poses;
    const auto add = [&](std::uint32_t below, const Vector& offset, std::uint32_t above, Pose pose) {
        const Vector position{4.0 * static_cast<double>(poses.size()), 0, 0};
        scene.bodies.push_back({.mesh = below});
        poses.push_back(at(position));
        pose.translation = pose.translation + offset + position;
        scene.bodies.push_back({.mesh = above});
        poses.push_back(pose);
    };
    const Vector on{0, 1 - depth, 0}; // both extend 0.5 from their origin
    enum : std::uint32_t { s, w, b, c };
    add(s, on, s, upside_down({0, 0, 0}));       // spike on spike
    add(w, on, s, upside_down({0, 0, 0}));       // spike on wedge
    add(w, on, w, upside_down({0, 0, 0}));       // wedge on parallel wedge
    add(b, on, s, upside_down({0.25, 0, 0.25})); // spike on a box, on edges inside its mesh
    add(c, on, s, upside_down({0, -0.5, 0}));    // spike in a crack, between its edges
    add(b, on, b, at({1, 0, 0}));                // box over a cliff's edge
    add(b, on, b, at({0.5, 0, 0.5}));            // box sliding over inner edges
    add(b, on, w, upside_down({0, 0, 0}));       // wedge on a box
    add(c, on, b, at({0, 0, 0}));                // box over a crack
    scene.frame = [poses](std::size_t) {
        return Frame{poses, std::vector<std::vector<Vector>>(poses.size())};
    };
    return scene;
}

/// A box of small cells that penetrates another. Inner faces and edges are not a surface; the normal is +y.
Scene interior_faces(Random&, double depth) {
    const auto box = grid({4, 4, 4}, {1, 1, 1});
    return still({box}, {at({0, 0, 0}), at({0.125, 1 - depth, 0.125})});
}

constexpr HardFamily contact_table[] = {
    {.row = 28,
     .group = 'd',
     .name = "opposing-faces",
     .summary = "nearly parallel faces of penetrating tetrahedra",
     .knob = {"angle", 1e-8, 0.1, 1e-6},
     .truth = HardTruth::geometry,
     .metric = "ANG, count of contacts",
     .fails = "the most opposing pair of faces changes with rounding",
     .pair = opposing_faces},
    {.row = 29,
     .group = 'd',
     .name = "edge-crossing",
     .summary = "crossing edges, one below the other",
     .knob = {"depth", 1e-6, 0.3, 1e-3},
     .truth = HardTruth::geometry,
     .metric = "ANG, PT",
     .fails = "normals taken from faces only",
     .pair = edge_crossing},
    {.row = 30,
     .group = 'd',
     .name = "deep",
     .summary = "a corner deep inside",
     .knob = {"fraction of the distance to the opposite corner", 0.001, 0.9, 0.5},
     .truth = HardTruth::geometry,
     .metric = "DREL, ANG, VOL",
     .fails = "contacts dropped for being too deep",
     .pair = deep},
    {.row = 31,
     .group = 'd',
     .name = "ties",
     .summary = "regular tetrahedra at one position with small noise",
     .knob = {"noise", 0, 0.1, 0},
     .truth = HardTruth::geometry,
     .metric = "number of best normals",
     .fails = "any rule that takes the first of equals",
     .pair = ties},
    {.row = 32,
     .group = 'd',
     .name = "configurations",
     .summary = "Erleben's spike, wedge, crack, cliff edge and sliding box: nine pairs of bodies",
     .knob = {"depth", 0, 0.25, 0.0625},
     .truth = HardTruth::geometry,
     .metric = "ANG, PT, count of contacts",
     .fails = "every method by some of them",
     .scene = configurations},
    {.row = 33,
     .group = 'd',
     .name = "vanishing-depth",
     .summary = "faces that barely penetrate",
     .knob = {"halvings of the depth", 8, 20, 16},
     .truth = HardTruth::geometry,
     .metric = "DULP",
     .fails = "relative errors of the depth",
     .pair = vanishing_depth},
    {.row = 34,
     .group = 'd',
     .name = "interior-faces",
     .summary = "a box of many tetrahedra pressed into another",
     .knob = {"depth", 0.001, 0.5, 0.0625},
     .truth = HardTruth::construction,
     .metric = "ANG to +y",
     .fails = "contacts from faces that are no surface",
     .scene = interior_faces},
    {.row = 35,
     .group = 'd',
     .name = "plane-division",
     .summary = "an edge that leaves a face at a small angle",
     .knob = {"angle", 1e-7, 0.1, 1e-5},
     .truth = HardTruth::geometry,
     .metric = "PT",
     .fails = "points found by dividing by almost nothing",
     .pair = plane_division}};

} // namespace

std::span<const HardFamily> contact_families() { return contact_table; }

} // namespace tandem::hard
