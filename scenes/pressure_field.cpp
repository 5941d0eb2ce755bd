// SPDX-License-Identifier: MIT
#include "scenes/pressure_field.h"

#include "base/error.h"
#include "base/parallel.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <unsupported/Eigen/BVH>

namespace tandem {

namespace {

using Point = Eigen::Vector3d;
using Box = Eigen::AlignedBox3d;

struct Triangle {
    Point a, b, c;
};

Box bounding_box(const Triangle& triangle) { // found by Eigen::KdBVH
    Box box(triangle.a);
    return box.extend(triangle.b).extend(triangle.c);
}

/// The squared distance of a point from an edge.
double squared_distance(const Point& p, const Point& a, const Point& b) {
    const Point edge = b - a;
    const double length = edge.squaredNorm();
    const double s = length > 0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0;
    return (p - a - s * edge).squaredNorm();
}

/// The squared distance of a point from a triangle: from its plane if the foot is inside, else from an edge.
double squared_distance(const Point& p, const Triangle& t) {
    const Point e = t.b - t.a, f = t.c - t.a, v = p - t.a, n = e.cross(f);
    const double square = n.squaredNorm(), of_b = v.dot(f.cross(n)), of_c = v.dot(n.cross(e));
    if (square > 0 && of_b >= 0 && of_c >= 0 && of_b + of_c <= square) {
        const double height = v.dot(n);
        return height * height / square;
    }
    return std::min(
        {squared_distance(p, t.a, t.b), squared_distance(p, t.b, t.c), squared_distance(p, t.c, t.a)});
}

/// What Eigen::BVMinimize minimizes.
struct FromPoint {
    using Scalar = double;
    Point point;

    double minimumOnVolume(const Box& box) const { return box.squaredExteriorDistance(point); }
    double minimumOnObject(const Triangle& triangle) const { return squared_distance(point, triangle); }
};

constexpr unsigned corners_of_face[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

template<class Visit>
void for_boundary_faces(const Mesh& mesh, Visit visit) {
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (unsigned face = 0; face < 4; ++face)
            if ((mesh.boundary[t] >> face & 1) != 0) visit(mesh.tetrahedra[t], corners_of_face[face]);
}

} // namespace

void make_pressures(Mesh& mesh, double modulus) {
    checked_pressure(modulus);
    std::vector<Triangle> triangles;
    std::vector<bool> is_outside(mesh.vertices.size());
    for_boundary_faces(mesh, [&](const Tetrahedron& ids, const unsigned(&at)[3]) {
        triangles.push_back(
            {mesh.vertices[ids[at[0]]], mesh.vertices[ids[at[1]]], mesh.vertices[ids[at[2]]]});
        for (const auto i : at) is_outside[ids[i]] = true;
    });
    mesh.pressures.assign(mesh.vertices.size(), 0);
    if (triangles.empty()) return;
    const Eigen::KdBVH<double, 3, Triangle> tree(triangles.begin(), triangles.end());
    parallel_for(mesh.vertices.size(), [&](std::size_t i) {
        FromPoint from{mesh.vertices[i]};
        if (!is_outside[i]) mesh.pressures[i] = std::sqrt(Eigen::BVMinimize(tree, from));
    });
    // Vertices of no tetrahedron do not count.
    double most = 0;
    for (const auto& tetrahedron : mesh.tetrahedra)
        for (const auto vertex : tetrahedron) most = std::max(most, mesh.pressures[vertex]);
    for (double& pressure : mesh.pressures)
        pressure = most > 0 ? modulus * std::min(1.0, pressure / most) : 0;
}

double most_pressure_on_boundary(const Mesh& mesh) {
    double most = 0;
    if (mesh.pressures.empty()) return most;
    for_boundary_faces(mesh, [&](const Tetrahedron& ids, const unsigned(&at)[3]) {
        for (const auto i : at) most = std::max(most, mesh.pressures[ids[i]]);
    });
    return most;
}

void check_pressures(const Mesh& mesh, const std::string& source) {
    if (mesh.pressures.empty()) return;
    if (mesh.pressures.size() != mesh.vertices.size())
        throw InputError(fmt::format("{}: {} pressures for {} vertices; give one a vertex", source,
                                     mesh.pressures.size(), mesh.vertices.size()));
    for (std::size_t v = 0; v < mesh.pressures.size(); ++v)
        if (!(mesh.pressures[v] >= 0 && mesh.pressures[v] <= most_pressure))
            throw InputError(fmt::format("{}: the pressure of vertex {} is {}; pressures are finite and not "
                                         "negative",
                                         source, v, mesh.pressures[v]));
}

std::size_t bodies_without_field(const Scene& scene) {
    return static_cast<std::size_t>(std::ranges::count_if(
        scene.bodies, [&](const Body& body) { return scene.meshes[body.mesh].pressures.empty(); }));
}

} // namespace tandem
