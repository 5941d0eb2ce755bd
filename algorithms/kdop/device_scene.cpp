// SPDX-License-Identifier: MIT
#include "algorithms/kdop/device_scene.h"

#include "algorithms/kdop/drift.h"
#include "algorithms/kdop/pack.h"
#include "algorithms/sources.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tandem {

namespace {

constexpr std::uint32_t body_words = 8;
constexpr std::uint32_t level_words = 4;
constexpr std::uint32_t job_words = 8;
constexpr std::uint32_t in_world_flag = 1;
constexpr std::uint32_t most_top_items = 1024; ///< of a level that one work-group refits

std::uint64_t groups_for(std::uint64_t items, std::uint64_t per_group) {
    return (items + per_group - 1) / per_group;
}

} // namespace

DeviceScene::DeviceScene(Device& device, const Scene& scene, const Geometry& geometry, std::uint32_t leaves,
                         std::uint32_t group_size, Residency residency)
    : device_(device),
      scene_(scene),
      geometry_(geometry),
      leaves_(leaves),
      group_size_(group_size),
      refit_shape_(refit_shape(geometry, group_size)),
      residency_(residency) {
    for (const auto& mesh : scene.meshes) {
        meshes_.push_back(ordered(mesh));
        if (geometry.truth == Truth::pose) reaches_.push_back(reach_of(mesh.vertices));
        mesh_levels_.push_back(chunk_levels(static_cast<std::uint32_t>(mesh.tetrahedra.size()), leaves));
    }
    lay_out();
    plan_strips();
    strips_kernel_ = compile("refit_strips");
    tops_kernel_ = compile("refit_tops");
    if (residency == Residency::published) transform_kernel_ = compile("transform_vertices");
    upload_static();
}

Kernel DeviceScene::compile(std::string_view entry) const {
    auto defines = geometry_defines(geometry_, refit_shape_.group_size);
    defines["LEAF_BITS"] = std::to_string(ceil_log2(leaves_));
    defines["TILE_NODES"] = std::to_string(refit_shape_.tile_nodes);
    return device_.compile(kernel_source("algorithms/kdop/refit.cl"), entry, defines);
}

bool DeviceScene::in_world(std::size_t body) const {
    return residency_ == Residency::published || scene_.bodies[body].deformable;
}

std::size_t DeviceScene::vertices_of(std::size_t body) const {
    return meshes_[scene_.bodies[body].mesh].vertices.size();
}

/// Assigns every body its rows: shared topology and rigid vertices by mesh, deformable vertices and nodes by
/// body. Published residency shares nothing.
void DeviceScene::lay_out() {
    const bool shared = residency_ == Residency::resident;
    std::vector<std::uint32_t> first_level, first_tetrahedron, first_vertex;
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh) {
        first_level.push_back(static_cast<std::uint32_t>(level_rows_.size() / level_words));
        for (const auto& level : mesh_levels_[mesh])
            level_rows_.insert(level_rows_.end(), {level.slot, level.items, level.chunks, 0});
        first_tetrahedron.push_back(static_cast<std::uint32_t>(tetrahedron_total_));
        first_vertex.push_back(static_cast<std::uint32_t>(vertex_total_));
        if (!shared) continue;
        tetrahedron_total_ += meshes_[mesh].ids.size();
        vertex_total_ += meshes_[mesh].vertices.size();
    }
    for (std::size_t body = 0; body < scene_.bodies.size(); ++body) {
        const auto mesh = scene_.bodies[body].mesh;
        const auto tetrahedra = static_cast<std::uint32_t>(meshes_[mesh].ids.size());
        const bool own_vertices = in_world(body);
        body_rows_.insert(body_rows_.end(),
                          {shared ? first_tetrahedron[mesh] : static_cast<std::uint32_t>(tetrahedron_total_),
                           own_vertices ? static_cast<std::uint32_t>(vertex_total_) : first_vertex[mesh],
                           static_cast<std::uint32_t>(slots_), first_level[mesh],
                           static_cast<std::uint32_t>(mesh_levels_[mesh].size()), tetrahedra,
                           own_vertices ? in_world_flag : 0u, 0u});
        if (!shared) tetrahedron_total_ += tetrahedra;
        if (own_vertices) vertex_total_ += vertices_of(body);
        slots_ += slot_count(mesh_levels_[mesh]);
    }
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (slots_ > most || vertex_total_ > most || tetrahedron_total_ > most)
        throw DeviceError("scene: more than 2^32 nodes, vertices or tetrahedra; leave bodies out");
}

/// Level by level, each from its deepest nodes up, in strips of at most strip_height + 1 depths. The small
/// levels above them are left to refit_tops.
void DeviceScene::plan_strips() {
    const auto is_small = [&](const std::vector<Level>& levels) {
        return first_top_level_ >= levels.size() || levels[first_top_level_].items <= most_top_items;
    };
    while (!std::all_of(mesh_levels_.begin(), mesh_levels_.end(), is_small)) ++first_top_level_;
    for (std::uint32_t level = 0; level < first_top_level_; ++level) {
        std::uint32_t deepest = 0;
        for (const auto& levels : mesh_levels_)
            if (level < levels.size())
                deepest = std::max(deepest, ceil_log2(std::min(levels[level].items, leaves_)));
        for (std::uint32_t bottom = deepest;;) {
            const auto top = bottom > strip_height ? bottom - strip_height : 0;
            strips_.push_back(
                {level, bottom - top, static_cast<std::uint32_t>(jobs_.size() / job_words), 0, 0});
            plan_strip(level, false, top);
            strips_.back().dynamic_jobs = strips_.back().jobs;
            plan_strip(level, true, top);
            if (top == 0) break;
            bottom = top - 1;
        }
    }
}

void DeviceScene::plan_strip(std::uint32_t level, bool fixed, std::uint32_t top) {
    for (std::uint32_t body = 0; body < scene_.bodies.size(); ++body) {
        const auto& levels = mesh_levels_[scene_.bodies[body].mesh];
        if (scene_.bodies[body].fixed != fixed || level >= levels.size()) continue;
        const auto* row = &body_rows_[body * body_words];
        for (std::uint32_t chunk = 0; chunk < levels[level].chunks; ++chunk) {
            const auto first = chunk * leaves_;
            const auto items = std::min(leaves_, levels[level].items - first);
            const auto base = row[2] + levels[level].slot + 2 * first;
            for (std::uint32_t root = 1u << top; root < std::min(2u << top, 2 * items); ++root) {
                jobs_.insert(jobs_.end(), {base, items, root, body, first, row[0], row[1], row[6]});
                ++strips_.back().jobs;
            }
        }
    }
}

std::vector<std::byte> DeviceScene::shared_vertices() const {
    std::vector<std::byte> bytes;
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh)
        pack_vertices(bytes, geometry_, meshes_[mesh], scene_.meshes[mesh].vertices);
    return bytes;
}

void DeviceScene::upload_static() {
    const StageScope scope(device_, Stage::write);
    const auto put = [&](Buffer& buffer, std::span<const std::byte> bytes, std::string_view label) {
        buffer = device_.allocate(bytes.size(), label);
        device_.upload(buffer, bytes);
    };
    std::vector<std::uint32_t> tetrahedra, ids;
    std::vector<std::uint8_t> boundary;
    const auto add = [&](const OrderedMesh& mesh) {
        tetrahedra.insert(tetrahedra.end(), mesh.tetrahedra.begin(), mesh.tetrahedra.end());
        ids.insert(ids.end(), mesh.ids.begin(), mesh.ids.end());
        boundary.insert(boundary.end(), mesh.boundary.begin(), mesh.boundary.end());
    };
    if (residency_ == Residency::resident)
        for (const auto& mesh : meshes_) add(mesh);
    else
        for (const auto& body : scene_.bodies) add(meshes_[body.mesh]);
    put(tetrahedra_, bytes_of(tetrahedra), "tetrahedra");
    put(ids_, bytes_of(ids), "tetrahedron ids");
    put(boundary_, bytes_of(boundary), "boundary faces");
    put(bodies_, bytes_of(body_rows_), "bodies");
    put(levels_, bytes_of(level_rows_), "levels");
    put(job_table_, bytes_of(jobs_), "refit jobs");
    std::vector<std::uint32_t> order(scene_.bodies.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto moving = [&](std::uint32_t body) { return !scene_.bodies[body].fixed; };
    moving_bodies_ =
        static_cast<std::uint32_t>(std::stable_partition(order.begin(), order.end(), moving) - order.begin());
    put(body_order_, bytes_of(order), "bodies to refit");
    const auto real = real_bytes(geometry_);
    nodes_ = device_.allocate(slots_ * static_cast<std::uint64_t>(geometry_.k) * real, "nodes");
    poses_ = device_.allocate(scene_.bodies.size() * pose_reals(geometry_) * real, "poses");
    vertices_ = device_.allocate(vertex_total_ * 4 * real, "vertices");
    if (residency_ == Residency::resident) {
        device_.upload(vertices_, shared_vertices());
        return;
    }
    local_vertices_ = device_.allocate(vertex_total_ * 4 * real, "local vertices");
    vertex_bodies_ = device_.allocate(vertex_total_ * 4, "vertex bodies");
}

std::array<double, 3> DeviceScene::drift_of(const Frame& frame, std::size_t body) const {
    if (geometry_.truth == Truth::vertices) return {};
    if (scene_.bodies[body].deformable) return drift_bound(frame.deformed[body], geometry_.precision);
    return drift_bound(frame.poses[body], reaches_[scene_.bodies[body].mesh], geometry_.precision);
}

void DeviceScene::pack_poses(std::vector<std::byte>& bytes, const Frame& frame) const {
    bytes.reserve(frame.poses.size() * pose_reals(geometry_) * real_bytes(geometry_));
    for (std::size_t body = 0; body < frame.poses.size(); ++body)
        pack_pose(bytes, geometry_, frame.poses[body], drift_of(frame, body));
}

void DeviceScene::upload_poses(const Frame& frame) {
    const auto moves = [this](const Body& body) {
        return !body.fixed && (!body.deformable || geometry_.truth == Truth::pose);
    };
    if (!fresh_ && std::none_of(scene_.bodies.begin(), scene_.bodies.end(), moves)) return;
    std::vector<std::byte> bytes;
    {
        const HostWork work(device_, Stage::preprocess, "pack poses");
        pack_poses(bytes, frame);
    }
    const StageScope scope(device_, Stage::write);
    device_.upload(poses_, bytes);
}

void DeviceScene::upload_deformed(const Frame& frame) {
    std::vector<std::byte> bytes;
    std::uint64_t first = vertex_total_;
    {
        const HostWork work(device_, Stage::preprocess, "pack vertices");
        for (std::size_t body = 0; body < scene_.bodies.size(); ++body) {
            if (!scene_.bodies[body].deformable) continue;
            first = std::min<std::uint64_t>(first, body_rows_[body * body_words + 1]);
            pack_vertices(bytes, geometry_, meshes_[scene_.bodies[body].mesh], frame.deformed[body]);
        }
    }
    if (bytes.empty()) return;
    const StageScope scope(device_, Stage::write);
    device_.upload(vertices_, bytes, first * 4 * real_bytes(geometry_));
}

void DeviceScene::refit(bool all) {
    const StageScope scope(device_, Stage::refit);
    for (const auto& s : strips_) {
        const auto per_group = strips_of_group(refit_shape_, s.height);
        const auto jobs = all ? s.jobs : s.dynamic_jobs;
        if (jobs == 0) continue;
        const std::array<Argument, 11> arguments{nodes_,      bodies_,   levels_,    poses_,
                                                 tetrahedra_, vertices_, job_table_, s.first_job,
                                                 jobs,        s.level,   s.height};
        device_.launch(strips_kernel_, {groups_for(jobs, per_group), refit_shape_.group_size}, arguments);
    }
    if (emptied_.bodies > 0) {
        const std::array<Argument, 4> arguments{nodes_, emptied_rows_, emptied_starts_, emptied_.rounds};
        device_.launch(empty_kernel_, {emptied_.bodies, refit_shape_.group_size}, arguments);
    }
    const std::array<Argument, 5> arguments{nodes_, bodies_, levels_, body_order_, first_top_level_};
    const auto bodies = all ? body_count() : moving_bodies_;
    if (bodies > 0) device_.launch(tops_kernel_, {bodies, refit_shape_.group_size}, arguments);
}

void DeviceScene::upload_emptied() {
    const auto put = [&](Buffer& buffer, const std::vector<std::uint32_t>& words, std::string_view label) {
        if (!buffer || buffer.bytes() < words.size() * 4) {
            buffer = {};
            buffer = device_.allocate(words.size() * 4, label);
        }
        device_.upload(buffer, bytes_of(words));
    };
    const StageScope scope(device_, Stage::write);
    put(emptied_rows_, emptied_.rows, "emptied nodes");
    put(emptied_starts_, emptied_.starts, "rounds of emptied nodes");
}

/// Plans the nodes that tetrahedra skipped by the frame change, when it skips others than the one before.
void DeviceScene::leave_out(const Frame& frame) {
    if (frame.skipped == skipped_) return;
    {
        const HostWork work(device_, Stage::preprocess, "skipped tetrahedra");
        EmptiedPlan plan(leaves_, first_top_level_);
        positions_.resize(meshes_.size());
        for (std::size_t body = 0; body < frame.skipped.size(); ++body) {
            if (frame.skipped[body].empty()) continue;
            const auto mesh = scene_.bodies[body].mesh;
            if (positions_[mesh].empty()) positions_[mesh] = inverse(meshes_[mesh].ids);
            plan.add(body_rows_[body * body_words + 2], mesh_levels_[mesh], frame.skipped[body],
                     positions_[mesh]);
        }
        emptied_ = plan.take();
        skipped_ = frame.skipped;
        fresh_ = true;
    }
    if (emptied_.bodies == 0) return;
    if (!emptied_rows_) empty_kernel_ = compile("empty_nodes");
    upload_emptied();
}

void DeviceScene::update(const Frame& frame) {
    leave_out(frame);
    if (residency_ == Residency::published) {
        update_published(frame);
        return;
    }
    upload_poses(frame);
    upload_deformed(frame);
    refit(fresh_);
    fresh_ = false;
}

} // namespace tandem
