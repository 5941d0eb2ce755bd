// SPDX-License-Identifier: MIT
#include "scenes/shapes.h"

#include "base/error.h"
#include "base/random.h"
#include "scenes/cubes.h"

#include <cmath>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr double pi = 0x1.921fb54442d18p1;
constexpr double grid = 0x1p18;

using Triangle = std::array<std::uint32_t, 3>;

/// Rounds to single precision; -0 becomes 0.
double single(double x) { return static_cast<double>(static_cast<float>(x)) + 0.0; }

/// Completes the mesh. Valid sizes in double can give flat tetrahedra after rounding: throws InputError.
Mesh completed(Mesh mesh, const std::string& name) {
    mesh.name = name;
    complete_mesh(mesh, name);
    if (mesh.inverted + mesh.degenerate > 0)
        throw InputError(
            fmt::format("a {} of the scene is flat in single precision; give less extreme sizes", name));
    return mesh;
}

/// Tetrahedra between a centre, which becomes the last vertex, and triangles that face outward.
Mesh fan(std::vector<Eigen::Vector3d> vertices, const std::vector<Triangle>& triangles,
         const std::string& name) {
    Mesh mesh;
    mesh.vertices = std::move(vertices);
    const auto centre = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(0, 0, 0);
    for (auto& v : mesh.vertices)
        for (auto& x : v) x = on_grid(x);
    for (const auto& [a, b, c] : triangles) mesh.tetrahedra.push_back({centre, a, b, c});
    return completed(std::move(mesh), name);
}

/// Adds the points of a horizontal circle, the first at +z, the next towards +x.
void add_circle(std::vector<Eigen::Vector3d>& vertices, std::size_t slices, double radius, double y) {
    for (std::size_t i = 0; i < slices; ++i) {
        const auto turn = sine_cosine(2 * pi * static_cast<double>(i) / static_cast<double>(slices));
        vertices.emplace_back(radius * turn.sine, y, radius * turn.cosine);
    }
}

/// Adds outward triangles between two circles whose vertices begin at `lower` and `upper`.
void add_band(std::vector<Triangle>& triangles, std::uint32_t lower, std::uint32_t upper,
              std::uint32_t slices) {
    for (std::uint32_t i = 0; i < slices; ++i) {
        const auto next = (i + 1) % slices;
        triangles.push_back({lower + i, lower + next, upper + next});
        triangles.push_back({lower + i, upper + next, upper + i});
    }
}

/// Adds outward triangles from a point on the axis, above or below, to a circle.
void add_cap(std::vector<Triangle>& triangles, std::uint32_t tip, std::uint32_t circle, std::uint32_t slices,
             bool above) {
    for (std::uint32_t i = 0; i < slices; ++i) {
        const auto next = (i + 1) % slices;
        triangles.push_back(above ? Triangle{tip, circle + i, circle + next}
                                  : Triangle{tip, circle + next, circle + i});
    }
}

} // namespace

double on_grid(double length) { return single(std::round(length * grid) / grid); }
double halved_on_grid(double length) { return 2 * on_grid(0.5 * length); }

Mesh box(const Eigen::Vector3d& size) {
    std::vector<Eigen::Vector3d> vertices;
    for (unsigned corner = 0; corner < 8; ++corner)
        vertices.emplace_back(((corner & 1) != 0 ? 0.5 : -0.5) * size.x(),
                              ((corner & 2) != 0 ? 0.5 : -0.5) * size.y(),
                              ((corner & 4) != 0 ? 0.5 : -0.5) * size.z());
    std::vector<Triangle> triangles;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const auto u = 1u << (axis + 1) % 3;
        const auto v = 1u << (axis + 2) % 3;
        const auto far = 1u << axis;
        triangles.insert(
            triangles.end(),
            {{far, far | u, far | u | v}, {far, far | u | v, far | v}, {0, u | v, u}, {0, v, u | v}});
    }
    return fan(std::move(vertices), triangles, "box");
}

Mesh hexahedron(const std::array<Eigen::Vector3d, 8>& corners) {
    Mesh mesh;
    mesh.vertices.assign(corners.begin(), corners.end());
    for (auto& v : mesh.vertices)
        for (auto& x : v) x = on_grid(x);
    mesh.tetrahedra.assign(tetrahedra_of_cube.begin(), tetrahedra_of_cube.end());
    return completed(std::move(mesh), "stone");
}

Mesh sphere(double radius, std::size_t slices, std::size_t stacks) {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<Triangle> triangles;
    const auto count = static_cast<std::uint32_t>(slices);
    for (std::size_t row = 1; row < stacks; ++row) {
        const auto turn = sine_cosine(pi * static_cast<double>(row) / static_cast<double>(stacks));
        const auto first = static_cast<std::uint32_t>(vertices.size());
        add_circle(vertices, slices, radius * turn.sine, -radius * turn.cosine);
        if (row > 1) add_band(triangles, first - count, first, count);
    }
    const auto tip = static_cast<std::uint32_t>(vertices.size());
    vertices.emplace_back(0, -radius, 0);
    vertices.emplace_back(0, radius, 0);
    add_cap(triangles, tip, 0, count, false);
    add_cap(triangles, tip + 1, tip - count, count, true);
    return fan(std::move(vertices), triangles, "sphere");
}

Mesh drum(std::size_t slices, double lower_radius, double upper_radius, double height) {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<Triangle> triangles;
    const auto count = static_cast<std::uint32_t>(slices);
    add_circle(vertices, slices, lower_radius, -0.5 * height);
    add_circle(vertices, slices, upper_radius, 0.5 * height);
    vertices.emplace_back(0, -0.5 * height, 0);
    vertices.emplace_back(0, 0.5 * height, 0);
    add_band(triangles, 0, count, count);
    add_cap(triangles, 2 * count, 0, count, false);
    add_cap(triangles, 2 * count + 1, count, count, true);
    return fan(std::move(vertices), triangles, "drum");
}

Mesh scaled(Mesh mesh, const Eigen::Vector3d& factors) {
    for (auto& v : mesh.vertices)
        for (int axis = 0; axis < 3; ++axis) v[axis] = single(v[axis] * factors[axis]);
    return completed(mesh, mesh.name);
}

} // namespace tandem
