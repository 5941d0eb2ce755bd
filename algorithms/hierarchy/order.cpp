// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/order.h"

#include "algorithms/hierarchy/sah_order.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tandem {

namespace {

constexpr std::uint32_t lattice = (1u << 21) - 1;

/// Spreads the 21 low bits of x to every third bit.
std::uint64_t spread(std::uint64_t x) {
    x &= lattice;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

Eigen::Vector3d centroid(const Mesh& mesh, const Tetrahedron& t) {
    return 0.25 * ((mesh.vertices[t[0]] + mesh.vertices[t[1]]) + (mesh.vertices[t[2]] + mesh.vertices[t[3]]));
}

std::uint32_t cell(double offset, double scale) {
    // The scale is finite and the offset non-negative, so that only the upper end needs clamping.
    return static_cast<std::uint32_t>(std::min(offset * scale, static_cast<double>(lattice)));
}

} // namespace

std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return spread(x) << 2 | spread(y) << 1 | spread(z);
}

std::vector<std::uint32_t> morton_order(const std::vector<Eigen::Vector3d>& points) {
    const auto count = points.size();
    Eigen::Vector3d lower = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d upper = -lower;
    for (const auto& c : points) {
        lower = lower.cwiseMin(c);
        upper = upper.cwiseMax(c);
    }
    const double extent = count ? (upper - lower).maxCoeff() : 0.0;
    // An extent of zero, or one so small that its inverse overflows, puts everything into one cell.
    const double scale = extent > std::numeric_limits<double>::min() * lattice ? lattice / extent : 0.0;
    std::vector<std::uint64_t> codes(count);
    std::transform(points.begin(), points.end(), codes.begin(), [&](const Eigen::Vector3d& c) {
        const Eigen::Vector3d offset = c - lower;
        return morton_code(cell(offset.x(), scale), cell(offset.y(), scale), cell(offset.z(), scale));
    });
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return codes[a] < codes[b]; });
    return order;
}

std::vector<std::uint32_t> morton_order(const Mesh& mesh) {
    std::vector<Eigen::Vector3d> centroids(mesh.tetrahedra.size());
    std::transform(mesh.tetrahedra.begin(), mesh.tetrahedra.end(), centroids.begin(),
                   [&](const auto& t) { return centroid(mesh, t); });
    return morton_order(centroids);
}

OrderedMesh ordered(const Mesh& mesh, Builder builder) {
    OrderedMesh result;
    result.ids = builder == Builder::sah ? sah_order(mesh) : morton_order(mesh);
    result.numbers.assign(mesh.vertices.size(), OrderedMesh::unused);
    for (const auto id : result.ids) {
        result.boundary.push_back(mesh.boundary[id]);
        for (const auto vertex : mesh.tetrahedra[id]) {
            auto& number = result.numbers[vertex];
            if (number == OrderedMesh::unused) {
                number = static_cast<std::uint32_t>(result.vertices.size());
                result.vertices.push_back(vertex);
            }
            result.tetrahedra.push_back(number);
        }
    }
    return result;
}

} // namespace tandem
