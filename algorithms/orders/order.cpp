// SPDX-License-Identifier: MIT
#include "algorithms/orders/order.h"

#include "algorithms/orders/breadth_order.h"
#include "algorithms/orders/median_order.h"
#include "algorithms/orders/sah_order.h"
#include "algorithms/parameters/table.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <stdexcept>

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
    // The scale is finite. The offset is non-negative, or NaN between infinities.
    const double position = offset * scale;
    if (position >= static_cast<double>(lattice)) return lattice;
    return position > 0 ? static_cast<std::uint32_t>(position) : 0;
}

/// Orders points by the code of their cell.
template<class Code>
std::vector<std::uint32_t> curve_order(const std::vector<Eigen::Vector3d>& points, Code code) {
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
        return code(cell(offset.x(), scale), cell(offset.y(), scale), cell(offset.z(), scale));
    });
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return codes[a] < codes[b]; });
    return order;
}

/// Order of a mesh by a builder.
std::vector<std::uint32_t> order_of(const Mesh& mesh, Builder builder) {
    if (mesh.tetrahedra.empty()) return {};
    switch (builder) {
    case Builder::morton:
        return morton_order(mesh);
    case Builder::sah:
        return sah_order(mesh);
    case Builder::breadth:
        return breadth_order(mesh);
    case Builder::hilbert:
        return hilbert_order(mesh);
    case Builder::median:
        return median_order(mesh);
    case Builder::balanced:
        return balanced_order(mesh);
    }
    throw std::invalid_argument("unknown builder");
}

/// Order of the walked tetrahedra alone, so that a builder's runs are full.
std::vector<std::uint32_t> walked_order(const Mesh& mesh, MeshOrder given) {
    if (count_walked(mesh, given.walked) == mesh.tetrahedra.size()) return order_of(mesh, given.builder);
    auto walked = walked_tetrahedra(mesh, given.walked);
    Mesh part;
    part.vertices = mesh.vertices;
    part.tetrahedra.reserve(walked.size());
    for (const auto id : walked) part.tetrahedra.push_back(mesh.tetrahedra[id]);
    auto order = order_of(part, given.builder);
    for (auto& position : order) position = walked[position];
    return order;
}

} // namespace

std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return spread(x) << 2 | spread(y) << 1 | spread(z);
}

std::uint64_t hilbert_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    std::array<std::uint32_t, 3> axes{x, y, z};
    // From the whole cube down: the octant at each bit determines how the curve inside it is rotated and
    // mirrored.
    for (std::uint32_t bit = (lattice + 1) / 2; bit > 1; bit /= 2) {
        const auto below = bit - 1;
        for (auto& axis : axes) {
            const auto swapped = (axis & bit) != 0 ? 0 : (axes[0] ^ axis) & below;
            axes[0] ^= (axis & bit) != 0 ? below : swapped;
            axis ^= swapped;
        }
    }
    // The curve visits octants in the order of a Gray code. The index of an octant is the exclusive or of the
    // bits above.
    axes[1] ^= axes[0];
    axes[2] ^= axes[1];
    std::uint32_t flipped = 0;
    for (std::uint32_t bit = (lattice + 1) / 2; bit > 1; bit /= 2)
        if ((axes[2] & bit) != 0) flipped ^= bit - 1;
    return morton_code(axes[0] ^ flipped, axes[1] ^ flipped, axes[2] ^ flipped);
}

std::vector<Eigen::Vector3d> centroids(const Mesh& mesh) {
    std::vector<Eigen::Vector3d> result(mesh.tetrahedra.size());
    std::transform(mesh.tetrahedra.begin(), mesh.tetrahedra.end(), result.begin(),
                   [&](const auto& t) { return centroid(mesh, t); });
    return result;
}

std::vector<std::uint32_t> morton_order(const std::vector<Eigen::Vector3d>& points) {
    return curve_order(points, morton_code);
}

std::vector<std::uint32_t> morton_order(const Mesh& mesh) { return morton_order(centroids(mesh)); }

std::vector<std::uint32_t> hilbert_order(const std::vector<Eigen::Vector3d>& points) {
    return curve_order(points, hilbert_code);
}

std::vector<std::uint32_t> hilbert_order(const Mesh& mesh) { return hilbert_order(centroids(mesh)); }

std::size_t count_walked(const Mesh& mesh, Walked walked) {
    const auto all = mesh.tetrahedra.size() - mesh.merged.size();
    if (walked != Walked::boundary) return all;
    const auto inner = static_cast<std::size_t>(std::ranges::count(mesh.boundary, std::uint8_t{0}));
    return inner == mesh.tetrahedra.size() ? all : mesh.tetrahedra.size() - inner;
}

std::size_t count_walked(const Scene& scene, Walked walked) {
    std::vector<std::size_t> counts;
    for (const auto& mesh : scene.meshes) counts.push_back(count_walked(mesh, walked));
    std::size_t sum = 0;
    for (const auto& body : scene.bodies) sum += counts[body.mesh];
    return sum;
}

std::vector<std::uint32_t> walked_tetrahedra(const Mesh& mesh, Walked walked) {
    std::vector<std::uint32_t> result;
    const auto count = count_walked(mesh, walked);
    result.reserve(count);
    const bool takes_inner = count == count_walked(mesh, Walked::all);
    for (std::uint32_t i = 0; i < mesh.tetrahedra.size(); ++i)
        if (takes_inner ? !is_merged(mesh, i) : mesh.boundary[i] != 0) result.push_back(i);
    return result;
}

OrderedMesh ordered(const Mesh& mesh, MeshOrder order) {
    OrderedMesh result;
    result.ids = walked_order(mesh, order);
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
        if (!mesh.welded.empty())
            for (const auto vertex : mesh.tetrahedra[id]) result.joined.push_back(mesh.welded[vertex]);
    }
    return result;
}

Walked walked_of(const Settings& settings) {
    if (bounds_pressures(settings)) return Walked::by_pressure;
    const bool leaves_out = leaves_out_pairs(settings[parameters::output])
                            && boundaries_needed(settings[parameters::contact_rule]) == 2
                            && !is_published(settings);
    return leaves_out ? Walked::boundary : Walked::all;
}

} // namespace tandem
