// SPDX-License-Identifier: MIT
#include "scenes/simulate/boundary.h"

#include "scenes/simulate/algebra.h"

#include <algorithm>
#include <limits>

namespace tandem::simulate {

namespace {

/// Normals of faces in one plane differ only by rounding.
constexpr double equal_normals = 1 - 1e-14;

double squared(const Eigen::Vector3d& v) { return dot(v, v); }

/// Unit normal of the triangle, away from `inside`; zero when it has no area.
Eigen::Vector3d outward(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                        const Eigen::Vector3d& inside) {
    const Eigen::Vector3d area = cross(b - a, c - a);
    const double size = length(area);
    if (!(size > 0)) return Eigen::Vector3d::Zero();
    return area / (dot(area, inside - a) > 0 ? -size : size);
}

void add_lowest(std::vector<NearFace>& faces, const NearFace& face) {
    for (auto& other : faces)
        if (dot(other.normal, face.normal) > equal_normals) {
            other.height = std::min(other.height, face.height);
            return;
        }
    faces.push_back(face);
}

} // namespace

double squared_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c) {
    const Eigen::Vector3d ab = b - a, ac = c - a, ap = point - a, bp = point - b, cp = point - c;
    const double ab_a = dot(ab, ap), ac_a = dot(ac, ap), ab_b = dot(ab, bp), ac_b = dot(ac, bp),
                 ab_c = dot(ab, cp), ac_c = dot(ac, cp);
    if (ab_a <= 0 && ac_a <= 0) return squared(ap);
    if (ab_b >= 0 && ac_b <= ab_b) return squared(bp);
    if (ac_c >= 0 && ab_c <= ac_c) return squared(cp);
    const double beyond_ab = ab_a * ac_b - ab_b * ac_a, beyond_ac = ab_c * ac_a - ab_a * ac_c,
                 beyond_bc = ab_b * ac_c - ab_c * ac_b;
    if (beyond_ab <= 0 && ab_a >= 0 && ab_b <= 0) return squared(ap - ab_a / (ab_a - ab_b) * ab);
    if (beyond_ac <= 0 && ac_a >= 0 && ac_c <= 0) return squared(ap - ac_a / (ac_a - ac_c) * ac);
    const double along_b = ac_b - ab_b, along_c = ab_c - ac_c;
    if (beyond_bc <= 0 && along_b >= 0 && along_c >= 0)
        return squared(bp - along_b / (along_b + along_c) * (c - b));
    const Eigen::Vector3d normal = cross(ab, ac);
    const double height = dot(normal, ap);
    return height * height / squared(normal);
}

Boundary::Boundary(const Mesh& mesh) : first_(mesh.vertices.size() + 1, 0) {
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (std::size_t corner = 0; corner < 4; ++corner) {
            if ((mesh.boundary[t] >> corner & 1) == 0) continue;
            Face face;
            for (std::size_t i = 0, n = 0; i < 4; ++i)
                if (i != corner) face.vertices[n++] = mesh.tetrahedra[t][i];
            const auto& [a, b, c] = face.vertices;
            face.normal = outward(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c],
                                  mesh.vertices[mesh.tetrahedra[t][corner]]);
            // A face without area is not part of the boundary.
            if (face.normal != Eigen::Vector3d::Zero()) faces_.push_back(face);
        }
    for (const auto& face : faces_)
        for (const auto v : face.vertices) ++first_[v + 1];
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    at_.resize(3 * faces_.size());
    auto next = first_;
    for (std::uint32_t i = 0; i < faces_.size(); ++i)
        for (const auto v : faces_[i].vertices) at_[next[v]++] = i;
}

void Boundary::near(const Mesh& mesh, std::uint32_t tetrahedron, const Eigen::Vector3d& point, double slack,
                    std::vector<NearFace>& faces) const {
    faces.clear();
    double nearest = std::numeric_limits<double>::max();
    // The first pass finds the smallest distance, the second one collects the faces.
    for (const bool only_nearest : {true, false})
        for (const auto v : mesh.tetrahedra[tetrahedron])
            for (auto i = first_[v]; i < first_[v + 1]; ++i) {
                const auto& face = faces_[at_[i]];
                const auto& corner = mesh.vertices[face.vertices[0]];
                const double distance = std::sqrt(squared_distance(
                    point, corner, mesh.vertices[face.vertices[1]], mesh.vertices[face.vertices[2]]));
                if (only_nearest)
                    nearest = std::min(nearest, distance);
                else if (distance <= nearest + slack)
                    add_lowest(faces, {face.normal, dot(face.normal, corner - point)});
            }
}

} // namespace tandem::simulate
