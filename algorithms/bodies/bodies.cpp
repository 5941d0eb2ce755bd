// SPDX-License-Identifier: MIT
#include "algorithms/bodies/bodies.h"

#include "algorithms/bodies/drift.h"
#include "algorithms/bodies/pack.h"
#include "backends/upload.h"

#include <algorithm>
#include <limits>

namespace tandem {

namespace {

constexpr std::uint32_t in_world_flag = 1; ///< BODY_IN_WORLD

} // namespace

std::vector<std::uint32_t> inverse(std::span<const std::uint32_t> order) {
    std::vector<std::uint32_t> positions(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) positions[order[i]] = i;
    return positions;
}

Bodies::Bodies(Device& device, const Scene& scene, const Geometry& geometry, Sharing sharing, Builder builder)
    : device_(device), scene_(scene), geometry_(geometry), sharing_(sharing) {
    for (const auto& mesh : scene.meshes) {
        meshes_.push_back(ordered(mesh, builder));
        if (geometry.placement == Placement::exact) reaches_.push_back(reach_of(mesh.vertices));
    }
    lay_out();
    upload_static();
}

bool Bodies::has_own_vertices(std::size_t body) const {
    return sharing_ == Sharing::none || scene_.bodies[body].deformable;
}

/// Gives every body its row: tetrahedra and rigid vertices by mesh where they are shared, the rest by body.
void Bodies::lay_out() {
    const bool shared = sharing_ == Sharing::by_mesh;
    std::vector<std::uint64_t> first_tetrahedron, first_vertex;
    for (const auto& mesh : meshes_) {
        first_tetrahedron.push_back(tetrahedron_total_);
        first_vertex.push_back(vertex_total_);
        if (!shared) continue;
        tetrahedron_total_ += mesh.ids.size();
        vertex_total_ += mesh.vertices.size();
    }
    for (std::size_t body = 0; body < scene_.bodies.size(); ++body) {
        const auto number = scene_.bodies[body].mesh;
        const auto& mesh = meshes_[number];
        const bool own = has_own_vertices(body);
        rows_.push_back({static_cast<std::uint32_t>(shared ? first_tetrahedron[number] : tetrahedron_total_),
                         static_cast<std::uint32_t>(own ? vertex_total_ : first_vertex[number]),
                         static_cast<std::uint32_t>(mesh.ids.size()), own ? in_world_flag : 0u});
        if (!shared) tetrahedron_total_ += mesh.ids.size();
        if (own) vertex_total_ += mesh.vertices.size();
        if (scene_.bodies[body].deformable) deformed_vertices_ += mesh.vertices.size();
    }
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (vertex_total_ > most || tetrahedron_total_ > most)
        throw DeviceError("scene: more than 2^32 vertices or tetrahedra; leave bodies out");
}

std::vector<std::byte> Bodies::shared_vertices() const {
    std::vector<std::byte> bytes;
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh)
        pack_vertices(bytes, geometry_, meshes_[mesh], scene_.meshes[mesh].vertices);
    return bytes;
}

/// What never changes: tetrahedra, ids, boundary, rows, and the vertices of meshes in their own frames.
void Bodies::upload_static() {
    std::vector<std::uint32_t> tetrahedra, ids;
    std::vector<std::uint8_t> boundary;
    const auto add = [&](const OrderedMesh& mesh) {
        tetrahedra.insert(tetrahedra.end(), mesh.tetrahedra.begin(), mesh.tetrahedra.end());
        ids.insert(ids.end(), mesh.ids.begin(), mesh.ids.end());
        boundary.insert(boundary.end(), mesh.boundary.begin(), mesh.boundary.end());
    };
    if (sharing_ == Sharing::by_mesh)
        for (const auto& mesh : meshes_) add(mesh);
    else
        for (const auto& body : scene_.bodies) add(meshes_[body.mesh]);
    tetrahedra_ = uploaded(device_, bytes_of(tetrahedra), "tetrahedra");
    ids_ = uploaded(device_, bytes_of(ids), "tetrahedron ids");
    boundary_ = uploaded(device_, bytes_of(boundary), "boundary faces");
    row_table_ = uploaded(device_, bytes_of(rows_), "bodies");
    const auto real = real_bytes(geometry_);
    poses_ = device_.allocate(scene_.bodies.size() * pose_reals(geometry_) * real, "poses");
    vertices_ = device_.allocate(vertex_total_ * 4 * real, "vertices");
    if (sharing_ == Sharing::none) return;
    const StageScope scope(device_, Stage::write);
    device_.upload(vertices_, shared_vertices());
}

std::size_t Bodies::bytes() const {
    std::size_t sum = 0;
    for (const auto* buffer : {&row_table_, &tetrahedra_, &ids_, &boundary_, &vertices_, &poses_})
        sum += buffer->bytes();
    return sum;
}

std::array<double, 3> Bodies::drift_of(const Frame& frame, std::size_t body) const {
    if (geometry_.placement == Placement::rounded) return {};
    if (scene_.bodies[body].deformable) return drift_bound(frame.deformed[body], geometry_.precision);
    return drift_bound(frame.poses[body], reaches_[scene_.bodies[body].mesh], geometry_.precision);
}

std::vector<std::byte> Bodies::packed_poses(const Frame& frame) const {
    std::vector<std::byte> bytes;
    bytes.reserve(frame.poses.size() * pose_reals(geometry_) * real_bytes(geometry_));
    for (std::size_t body = 0; body < frame.poses.size(); ++body)
        pack_pose(bytes, geometry_, frame.poses[body], drift_of(frame, body));
    return bytes;
}

/// A scene in which nothing rigid moves uploads its poses with `all` only. With placement=exact deformable
/// bodies have a drift that changes with their vertices and travels with the pose.
void Bodies::upload_poses(const Frame& frame, bool all) {
    const auto moves = [this](const Body& body) {
        return !body.fixed && (!body.deformable || geometry_.placement == Placement::exact);
    };
    if (!all && std::none_of(scene_.bodies.begin(), scene_.bodies.end(), moves)) return;
    std::vector<std::byte> bytes;
    {
        const HostWork work(device_, Stage::preprocess, "pack poses");
        bytes = packed_poses(frame);
    }
    const StageScope scope(device_, Stage::write);
    device_.upload(poses_, bytes);
}

/// Vertices of deformable bodies lie behind one another, so that one upload takes them all.
void Bodies::upload_deformed(const Frame& frame) {
    std::vector<std::byte> bytes;
    std::uint64_t first = vertex_total_;
    {
        const HostWork work(device_, Stage::preprocess, "pack vertices");
        bytes.reserve(deformed_vertices_ * 4 * real_bytes(geometry_));
        for (std::size_t body = 0; body < scene_.bodies.size(); ++body) {
            if (!scene_.bodies[body].deformable) continue;
            first = std::min<std::uint64_t>(first, rows_[body].vertices);
            pack_vertices(bytes, geometry_, mesh(body), frame.deformed[body]);
        }
    }
    if (bytes.empty()) return;
    const StageScope scope(device_, Stage::write);
    device_.upload(vertices_, bytes, first * 4 * real_bytes(geometry_));
}

void Bodies::update(const Frame& frame, bool all) {
    upload_poses(frame, all);
    upload_deformed(frame);
}

} // namespace tandem
