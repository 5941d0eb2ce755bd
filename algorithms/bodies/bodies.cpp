// SPDX-License-Identifier: MIT
#include "algorithms/bodies/bodies.h"

#include "algorithms/bodies/arc.h"
#include "algorithms/bodies/drift.h"
#include "algorithms/bodies/pack.h"
#include "algorithms/bodies/shift.h"
#include "backends/upload.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tandem {

namespace {

constexpr std::uint32_t in_world_flag = 1; ///< BODY_IN_WORLD
constexpr std::uint32_t block_shift = 1;   ///< BODY_BLOCK_SHIFT
constexpr std::uint64_t most_blocks = (std::uint64_t{1} << 32) / Bodies::block_slots;

} // namespace

Bodies::Bodies(Device& device, const Scene& scene, const Geometry& geometry, Sharing sharing, MeshOrder order,
               PairLayout pair_layout)
    : device_(device),
      scene_(scene),
      geometry_(geometry),
      sharing_(sharing),
      pair_layout_(sharing == Sharing::by_mesh ? pair_layout : PairLayout::items) {
    for (const auto& mesh : scene.meshes) {
        meshes_.push_back(ordered(mesh, order));
        if (geometry.placement == Placement::exact) mesh_reaches_.push_back(reach_of(mesh.vertices));
        if (geometry.pressures && mesh.pressures.empty())
            no_pressures_.resize(std::max(no_pressures_.size(), mesh.vertices.size()), -1);
    }
    lay_out();
    lay_out_slots();
    plan_runs();
    upload_static();
}

bool Bodies::has_own_vertices(std::size_t body) const {
    return sharing_ == Sharing::none || scene_.bodies[body].deformable;
}

/// Assigns every body its row. Shared tetrahedra and rigid vertices are stored once a mesh, the rest by body.
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
    }
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (vertex_total_ > most || tetrahedron_total_ > most)
        throw DeviceError("scene: more than 2^32 vertices or tetrahedra; use fewer bodies");
}

void Bodies::lay_out_slots() {
    slot_order_.resize(rows_.size());
    std::iota(slot_order_.begin(), slot_order_.end(), 0u);
    std::stable_partition(slot_order_.begin(), slot_order_.end(),
                          [&](std::uint32_t body) { return !scene_.bodies[body].fixed; });
    std::uint64_t blocks = 0;
    for (const auto body : slot_order_) {
        first_blocks_.push_back(blocks);
        blocks += (std::uint64_t{rows_[body].tetrahedron_count} + block_slots - 1) / block_slots;
    }
    if (blocks > most_blocks) pair_layout_ = PairLayout::items;
    if (pair_layout_ == PairLayout::items) return;
    for (std::size_t i = 0; i < slot_order_.size(); ++i)
        rows_[slot_order_[i]].flags |= static_cast<std::uint32_t>(first_blocks_[i]) << block_shift;
    first_blocks_.push_back(blocks);
}

/// Rows of blocks: as rows of bodies, but with the body in place of the number of tetrahedra.
std::vector<Bodies::BodyRow> Bodies::block_rows() const {
    std::vector<BodyRow> blocks;
    blocks.reserve(first_blocks_.back());
    for (std::size_t i = 0; i < slot_order_.size(); ++i) {
        const auto body = slot_order_[i];
        auto block = rows_[body];
        block.tetrahedron_count = body;
        for (auto rest = first_blocks_[i + 1] - first_blocks_[i]; rest > 0; --rest) {
            blocks.push_back(block);
            block.tetrahedra += block_slots;
        }
    }
    return blocks;
}

std::uint32_t Bodies::first_slot(std::size_t body) const {
    return (rows_[body].flags >> block_shift) * block_slots;
}

Bodies::SlotOwner Bodies::slot_owner(std::uint32_t slot) const {
    const auto next = std::upper_bound(first_blocks_.begin(), first_blocks_.end(), slot / block_slots);
    const auto i = static_cast<std::size_t>(next - first_blocks_.begin()) - 1;
    return {slot_order_[i], static_cast<std::uint32_t>(slot - first_blocks_[i] * block_slots)};
}

std::uint32_t Bodies::position_of(std::size_t body, std::uint32_t tetrahedron) const {
    const auto number = scene_.bodies[body].mesh;
    positions_.resize(meshes_.size());
    auto& positions = positions_[number];
    if (positions.empty()) {
        positions.assign(scene_.meshes[number].tetrahedra.size(), OrderedMesh::unused);
        const auto& ids = meshes_[number].ids;
        for (std::uint32_t i = 0; i < ids.size(); ++i) positions[ids[i]] = i;
    }
    return positions[tetrahedron];
}

std::vector<std::uint32_t> Bodies::positions_of(std::size_t body,
                                                std::span<const std::uint32_t> tetrahedra) const {
    std::vector<std::uint32_t> result;
    for (const auto tetrahedron : tetrahedra)
        if (const auto position = position_of(body, tetrahedron); position != OrderedMesh::unused)
            result.push_back(position);
    return result;
}

std::vector<std::byte> Bodies::shared_vertices() const {
    std::vector<std::byte> bytes;
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh) {
        const auto& vertices = scene_.meshes[mesh].vertices;
        if (geometry_.motion == Motion::linear)
            pack_vertices_with_distances(bytes, geometry_, meshes_[mesh], vertices, shift_in(scene_, mesh));
        else
            pack_vertices(bytes, geometry_, meshes_[mesh], vertices, pressures(mesh));
    }
    return bytes;
}

/// Uploads constant data: tetrahedra, ids, boundary, rows, and vertices in mesh coordinates.
void Bodies::upload_static() {
    std::vector<std::uint32_t> tetrahedra, topology, ids{count()};
    std::vector<std::uint8_t> boundary;
    const auto add = [&](const OrderedMesh& mesh) {
        tetrahedra.insert(tetrahedra.end(), mesh.tetrahedra.begin(), mesh.tetrahedra.end());
        topology.insert(topology.end(), mesh.topology().begin(), mesh.topology().end());
        ids.insert(ids.end(), mesh.ids.begin(), mesh.ids.end());
        boundary.insert(boundary.end(), mesh.boundary.begin(), mesh.boundary.end());
    };
    for (std::size_t body = 0; body < scene_.bodies.size(); ++body) ids.push_back(number_of(scene_, body));
    if (sharing_ == Sharing::by_mesh)
        for (const auto& mesh : meshes_) add(mesh);
    else
        for (const auto& body : scene_.bodies) add(meshes_[body.mesh]);
    tetrahedra_ = uploaded(device_, bytes_of(tetrahedra), "tetrahedra");
    if (std::ranges::any_of(meshes_, [](const auto& mesh) { return !mesh.joined.empty(); }))
        topology_ = uploaded(device_, bytes_of(topology), "topology of welded meshes");
    ids_ = uploaded(device_, bytes_of(ids), "numbers of bodies and tetrahedra");
    boundary_ = uploaded(device_, bytes_of(boundary), "boundary faces");
    row_table_ = uploaded(device_, bytes_of(rows_), "bodies");
    if (pair_layout_ == PairLayout::slots)
        blocks_ = uploaded(device_, bytes_of(block_rows()), "blocks of slots");
    const auto real = real_bytes(geometry_);
    poses_ = device_.allocate(scene_.bodies.size() * pose_reals(geometry_) * real, "poses");
    vertices_ = device_.allocate(vertex_total_ * 4 * real, "vertices");
    if (geometry_.motion == Motion::linear) {
        next_poses_ = device_.allocate(poses_.bytes(), "poses of the next frame");
        next_vertices_ = device_.allocate(vertices_.bytes(), "vertices of the next frame");
    }
    if (sharing_ == Sharing::none) return;
    const StageScope scope(device_, Stage::write);
    const auto shared = shared_vertices();
    device_.upload(vertices_, shared);
    if (next_vertices_) device_.upload(next_vertices_, shared);
}

std::span<const double> Bodies::pressures(std::size_t mesh) const {
    if (!geometry_.pressures) return {};
    const auto& own = scene_.meshes[mesh].pressures;
    return own.empty() ? std::span(no_pressures_).first(scene_.meshes[mesh].vertices.size()) : own;
}

std::size_t Bodies::bytes() const {
    std::size_t sum = 0;
    for (const auto* buffer : {&row_table_, &blocks_, &tetrahedra_, &topology_, &ids_, &boundary_, &vertices_,
                               &poses_, &next_vertices_, &next_poses_})
        sum += buffer->bytes();
    return sum;
}

std::array<double, 3> Bodies::drift_of(const Frame& frame, std::size_t body) const {
    if (geometry_.placement == Placement::rounded) return {};
    if (scene_.bodies[body].deformable) return drift_bound(frame.deformed[body], geometry_.precision);
    const auto mesh = scene_.bodies[body].mesh;
    return drift_bound(frame.poses[body], mesh_reaches_[mesh], geometry_.precision, shift_in(scene_, mesh));
}

/// The arcs of all bodies; empty with motion=none. Deformable bodies move on straight paths.
std::vector<double> Bodies::arcs_of(const FrameInput& input) const {
    std::vector<double> arcs;
    if (input.next == nullptr) return arcs;
    for (std::size_t body = 0; body < input.frame.poses.size(); ++body) {
        const bool turns = needs(body) && !scene_.bodies[body].deformable;
        arcs.push_back(turns ? arc_between(input.frame.poses[body], input.next->poses[body]) : 0);
    }
    return arcs;
}

std::vector<std::byte> Bodies::packed_poses(const Frame& frame, std::span<const double> arcs) const {
    std::vector<std::byte> bytes;
    const auto row = pose_reals(geometry_) * real_bytes(geometry_);
    bytes.reserve(frame.poses.size() * row);
    for (std::size_t body = 0; body < frame.poses.size(); ++body) {
        if (needs(body))
            pack_pose(bytes, geometry_, frame.poses[body], drift_of(frame, body),
                      arcs.empty() ? 0 : arcs[body]);
        else
            bytes.resize(bytes.size() + row);
    }
    return bytes;
}

/// Without moving rigid bodies, poses are uploaded with `all` only. With placement=exact the pose of a
/// deformable body has its drift, which changes with its vertices.
bool Bodies::changes_poses(bool all) const {
    const auto moves = [this](const Body& body) {
        return !body.fixed && (!body.deformable || geometry_.placement == Placement::exact);
    };
    return all || std::any_of(scene_.bodies.begin(), scene_.bodies.end(), moves);
}

void Bodies::update_poses(const FrameInput& input, bool all) {
    if (!changes_poses(all)) return;
    std::vector<std::byte> bytes, next_bytes;
    {
        const HostWork work(device_, Stage::preprocess, "pack poses");
        const auto arcs = arcs_of(input);
        bytes = packed_poses(input.frame, arcs);
        if (input.next != nullptr) next_bytes = packed_poses(*input.next, arcs);
    }
    const StageScope scope(device_, Stage::write);
    device_.upload(poses_, bytes);
    if (input.next != nullptr) device_.upload(next_poses_, next_bytes);
}

void Bodies::set_subdomain(const Subdomain& subdomain) {
    roles_ = roles_of(subdomain, rows_.size());
    plan_runs();
}

void Bodies::exclude_from_upload(std::span<const std::uint32_t> bodies) {
    is_excluded_.assign(bodies.empty() ? 0 : rows_.size(), false);
    for (const auto body : bodies) is_excluded_[body] = true;
    plan_runs();
}

/// Vertices of deformable bodies are consecutive, so that one upload covers several bodies. It also covers
/// bodies that need no upload if their vertices are few.
void Bodies::plan_runs() {
    constexpr std::uint64_t longest_gap = 4096; // vertices; costs less time than another upload
    runs_.clear();
    for (std::uint32_t body = 0; body < rows_.size(); ++body) {
        const bool is_excluded = !is_excluded_.empty() && is_excluded_[body];
        if (!scene_.bodies[body].deformable || !needs(body) || is_excluded) continue;
        const auto& row = rows_[body];
        if (runs_.empty() || row.vertices - runs_.back().end > longest_gap)
            runs_.push_back({row.vertices, row.vertices, {}});
        runs_.back().bodies.push_back(body);
        runs_.back().end = row.vertices + mesh(body).vertices.size();
    }
}

void Bodies::update_deformed(const FrameInput& input, bool waits) {
    upload_deformed(input.frame, vertices_, waits);
    if (input.next != nullptr) upload_deformed(*input.next, next_vertices_, waits);
}

void Bodies::upload_deformed(const Frame& frame, const Buffer& vertices, bool waits) {
    const auto row = 4 * real_bytes(geometry_);
    for (const auto& run : runs_) {
        std::vector<std::byte> bytes;
        {
            const HostWork work(device_, Stage::preprocess, "pack vertices");
            bytes.reserve((run.end - run.first) * row);
            for (const auto body : run.bodies) {
                bytes.resize((rows_[body].vertices - run.first) * row);
                pack_vertices(bytes, geometry_, mesh(body), frame.deformed[body],
                              pressures(scene_.bodies[body].mesh));
            }
        }
        if (bytes.empty()) continue;
        const StageScope scope(device_, Stage::write);
        device_.upload(vertices, bytes, run.first * row, waits);
    }
}

void Bodies::update(const FrameInput& input, bool all) {
    update_poses(input, all);
    update_deformed(input);
}

} // namespace tandem
