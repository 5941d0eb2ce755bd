// SPDX-License-Identifier: MIT
#include "algorithms/distributed/device_vertex_exchange.h"

#include "algorithms/parameters/table.h"
#include "algorithms/distributed/bytes.h"
#include "algorithms/distributed/local_scene.h"

#include <algorithm>
#include <array>

namespace tandem {

namespace {

/// Number of vertices that a tetrahedron uses; only these have rows.
std::size_t used_vertices(const Mesh& mesh) {
    std::vector<bool> is_used(mesh.vertices.size());
    for (const auto& tetrahedron : mesh.tetrahedra)
        for (const auto vertex : tetrahedron) is_used[vertex] = true;
    return static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), true));
}

template<class Real>
void read_rows(std::span<const std::byte> rows, const OrderedMesh& mesh,
               std::vector<Eigen::Vector3d>& vertices) {
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        std::array<Real, 4> row{};
        std::memcpy(row.data(), rows.data() + i * sizeof(row), sizeof(row));
        vertices[mesh.vertices[i]] = {row[0], row[1], row[2]};
    }
}

} // namespace

DeviceVertexExchange::DeviceVertexExchange(Ranks& ranks, const DeviceInfo& info, const Scene& scene,
                                           const Settings& settings)
    : ranks_(ranks), scene_(scene) {
    const auto geometry = geometry_of(settings);
    for (const auto& mesh : scene.meshes) bytes_.push_back(used_vertices(mesh) * 4 * real_bytes(geometry));
    // With placement=exact the host needs the vertices, because it bounds their drift. With motion=linear
    // there are vertices of two frames, and it bounds the bodies' paths.
    const bool is_supported = ranks.is_gpu_aware(info) && geometry.placement == Placement::rounded
                              && geometry.motion == Motion::none
                              && std::ranges::any_of(scene.bodies, &Body::deformable);
    const std::array own{is_supported ? 1 : 0, static_cast<int>(geometry.precision),
                         static_cast<int>(settings[parameters::builder])};
    const auto all = ranks.gather_to_all(std::as_bytes(std::span(own)));
    is_enabled_ = is_supported && std::ranges::all_of(all, [&](const auto& one) {
                      return MessageReader(one).template read<std::array<int, 3>>() == own;
                  });
}

std::vector<Ranks::Piece> DeviceVertexExchange::pieces(const std::vector<std::vector<std::uint32_t>>& lists,
                                                       const Bodies* bodies, const Scene* local_scene) {
    std::vector<Ranks::Piece> pieces;
    for (std::size_t rank = 0; rank < lists.size(); ++rank)
        for (const auto number : lists[rank]) {
            const auto bytes = bytes_[scene_.bodies[number].mesh];
            void* memory = scratch_.data();
            if (bodies != nullptr) {
                const auto row = 4 * real_bytes(bodies->geometry());
                memory = static_cast<std::byte*>(bodies->vertices().native())
                         + bodies->row(local_index(*local_scene, number)).vertices * row;
            }
            pieces.push_back({static_cast<int>(rank), memory, bytes});
        }
    return pieces;
}

void DeviceVertexExchange::exchange(const GhostExchange& ghosts, const Bodies* bodies,
                                    const Scene* local_scene, GhostExchange::Traffic& traffic) {
    if (bodies == nullptr) scratch_.resize(*std::ranges::max_element(bytes_));
    const auto out = pieces(ghosts.deformed_sent(), bodies, local_scene);
    const auto in = pieces(ghosts.deformed_received(), bodies, local_scene);
    ranks_.exchange_device(out, in);
    for (const auto& piece : out) traffic.bytes += piece.bytes;
    traffic.messages += out.size();
}

void DeviceVertexExchange::download_received(const GhostExchange& ghosts, const Bodies& bodies,
                                             const Scene& local_scene, Frame& frame) const {
    for (const auto& list : ghosts.deformed_received())
        for (const auto number : list) {
            const auto body = local_index(local_scene, number);
            const auto row = 4 * real_bytes(bodies.geometry());
            std::vector<std::byte> rows(bytes_[scene_.bodies[number].mesh]);
            const StageScope scope(bodies.device(), Stage::exchange);
            bodies.device().download(bodies.vertices(), rows, bodies.row(body).vertices * row);
            auto& vertices = frame.deformed[body];
            vertices.resize(scene_.meshes[scene_.bodies[number].mesh].vertices.size());
            if (bodies.geometry().precision == Precision::fp64)
                read_rows<double>(rows, bodies.mesh(body), vertices);
            else
                read_rows<float>(rows, bodies.mesh(body), vertices);
        }
}

} // namespace tandem
