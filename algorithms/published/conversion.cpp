// SPDX-License-Identifier: MIT
#include "algorithms/published/conversion.h"

#include "algorithms/bodies/pack.h"
#include "base/fork_join.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

namespace tandem {

namespace {

constexpr std::size_t block = std::size_t{1} << 18; ///< bytes that a thread processes at a time
constexpr std::size_t least_for_threads = 4;        ///< parts; fewer finish before another thread starts

std::size_t blocks_of(std::size_t bytes) { return (bytes + block - 1) / block; }

} // namespace

Converter::Converter(const Bodies& bodies, Conversion conversion, std::uint32_t threads) : bodies_(bodies) {
    if (conversion == Conversion::serial) return;
    const auto cores = tbb::info::default_concurrency();
    const auto wanted = threads == 0 ? cores : static_cast<int>(threads);
    // As in host_device.cpp: by default, oneTBB has no more threads than cores.
    if (wanted > cores)
        more_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(wanted));
    arena_.emplace(wanted);
}

void Converter::each(std::size_t count, const std::function<void(std::size_t)>& part) {
    if (!arena_ || count < least_for_threads) {
        for (std::size_t i = 0; i < count; ++i) part(i);
        return;
    }
    using Parts = tbb::blocked_range<std::size_t>;
    ForkJoin edges;
    const auto work = [&](const Parts& parts) {
        const ForkJoin::Part own(edges);
        for (auto i = parts.begin(); i != parts.end(); ++i) part(i);
    };
    arena_->execute([&] { tbb::parallel_for(Parts(0, count), SynchronizedWork(work)); });
}

/// Each array stores a body at the position of its row.
void Converter::convert_body(const Frame& frame, std::uint32_t body, Converted& converted) const {
    const auto& scene = bodies_.scene();
    const auto& mesh = bodies_.mesh(body);
    const auto& row = bodies_.row(body);
    const auto& geometry = bodies_.geometry();
    const bool deformable = scene.bodies[body].deformable;
    write_vertices(converted.vertices.data() + std::size_t{row.vertices} * 4 * real_bytes(geometry), geometry,
                   mesh, deformable ? frame.deformed[body] : scene.meshes[scene.bodies[body].mesh].vertices);
    std::fill_n(converted.vertex_bodies.begin() + row.vertices, mesh.vertices.size(), body);
    std::copy(mesh.tetrahedra.begin(), mesh.tetrahedra.end(),
              converted.tetrahedra.begin() + std::ptrdiff_t{4} * row.tetrahedra);
    std::copy(mesh.boundary.begin(), mesh.boundary.end(), converted.boundary.begin() + row.tetrahedra);
}

/// Fills `bytes` with empty nodes, which bound nothing.
template<class Real>
void Converter::empty_nodes(Converted::Array<std::byte>& nodes, std::size_t bytes) {
    const auto k = static_cast<std::size_t>(bodies_.geometry().k);
    nodes.resize(bytes);
    each(blocks_of(bytes), [&](std::size_t part) {
        const auto first = part * (block / sizeof(Real));
        const auto end = std::min((part + 1) * block, bytes) / sizeof(Real);
        for (auto i = first; i < end; ++i) {
            const auto value =
                i % k < k / 2 ? std::numeric_limits<Real>::max() : std::numeric_limits<Real>::lowest();
            std::memcpy(nodes.data() + i * sizeof(Real), &value, sizeof(Real));
        }
    });
}

Converted Converter::convert(const Frame& frame, std::size_t node_bytes) {
    const auto& bodies = bodies_.scene().bodies;
    const auto& geometry = bodies_.geometry();
    std::size_t tetrahedra = 0;
    for (std::size_t body = 0; body < bodies.size(); ++body)
        tetrahedra += bodies_.row(body).tetrahedron_count;
    Converted converted;
    converted.rigid =
        std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return !body.deformable; });
    converted.vertices.resize(bodies_.vertex_total() * 4 * real_bytes(geometry));
    converted.vertex_bodies.resize(bodies_.vertex_total());
    converted.tetrahedra.resize(4 * tetrahedra);
    converted.boundary.resize(tetrahedra);
    each(bodies.size(),
         [&](std::size_t body) { convert_body(frame, static_cast<std::uint32_t>(body), converted); });
    converted.poses = bodies_.packed_poses(frame);
    if (geometry.precision == Precision::fp64)
        empty_nodes<double>(converted.nodes, node_bytes);
    else
        empty_nodes<float>(converted.nodes, node_bytes);
    return converted;
}

} // namespace tandem
