// SPDX-License-Identifier: MIT
#include "algorithms/broad/broad_stage.h"

#include "algorithms/broad/tile.clh"
#include "algorithms/sources.h"
#include "scenes/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

constexpr std::uint32_t most_bodies = (1u << 15) * BROAD_TILE; ///< 2^30 pairs of tiles, numbered by a word

std::uint32_t tiles_of(std::uint32_t bodies) { return (bodies + BROAD_TILE - 1) / BROAD_TILE; }

Eigen::Vector3d centre_of(const std::vector<Eigen::Vector3d>& vertices) {
    Eigen::Vector3d lower = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d upper = -lower;
    for (const auto& v : vertices) {
        lower = lower.cwiseMin(v);
        upper = upper.cwiseMax(v);
    }
    return 0.5 * (lower + upper);
}

} // namespace

BroadStage::BroadStage(const DeviceScene& scene, const Scene& bodies, std::uint32_t groups)
    : scene_(scene),
      bodies_(bodies),
      group_size_(std::min<std::uint32_t>(scene.group_size(), BROAD_TILE)),
      groups_(groups * (scene.group_size() / group_size_)) {
    const auto count = scene.body_count();
    if (bodies.bodies.size() > most_bodies)
        throw InputError(fmt::format("setting broad=device takes at most {} bodies and the scene has {}; "
                                     "choose broad=tight",
                                     most_bodies, bodies.bodies.size()));
    for (const auto& mesh : bodies.meshes) mesh_centres_.push_back(centre_of(mesh.vertices));
    const auto defines = geometry_defines(scene.geometry(), group_size_);
    const auto& source = kernel_source("algorithms/broad/broad.cl");
    bound_ = scene.device().compile(source, "bound_tiles", defines);
    find_ = scene.device().compile(source, "find_body_pairs", defines);
    const auto volume = static_cast<std::uint64_t>(scene.geometry().k) * real_bytes(scene.geometry());
    order_ = scene.device().allocate(std::uint64_t{count} * 4, "order of bodies");
    roots_ = scene.device().allocate(count * volume, "root volumes");
    unions_ = scene.device().allocate(tiles_of(count) * volume, "unions of tiles");
}

std::uint64_t BroadStage::most_pairs() const {
    const std::uint64_t bodies = scene_.body_count();
    return bodies * (bodies - 1) / 2;
}

std::vector<Eigen::Vector3d> BroadStage::centres(const Frame& frame) const {
    std::vector<Eigen::Vector3d> centres;
    for (std::size_t body = 0; body < bodies_.bodies.size(); ++body) {
        const auto& pose = frame.poses[body];
        centres.push_back(bodies_.bodies[body].deformable
                              ? centre_of(frame.deformed[body])
                              : pose.rotation.normalized() * mesh_centres_[bodies_.bodies[body].mesh]
                                    + pose.translation);
    }
    return centres;
}

void BroadStage::sort(const Frame& frame) {
    std::vector<std::uint32_t> order;
    {
        const HostWork work(scene_.device(), Stage::broad, "sort bodies");
        order = morton_order(centres(frame));
        const auto moving = [&](std::uint32_t body) { return !bodies_.bodies[body].fixed; };
        const auto fixed = std::stable_partition(order.begin(), order.end(), moving);
        moving_count_ = static_cast<std::uint32_t>(fixed - order.begin());
    }
    const StageScope scope(scene_.device(), Stage::write);
    scene_.device().upload(order_, bytes_of(order));
}

void BroadStage::launch(const Buffer& pairs, std::uint32_t capacity, const Buffer& status) {
    const StageScope scope(scene_.device(), Stage::broad);
    const auto count = scene_.body_count();
    const std::array<Argument, 6> bound{scene_.nodes(), scene_.bodies(), order_, count, roots_, unions_};
    scene_.device().launch(bound_, {tiles_of(count), group_size_}, bound);
    const std::array<Argument, 8> find{roots_,        unions_, order_,   count,
                                       moving_count_, pairs,   capacity, status};
    const auto tile_pairs = tiles_of(moving_count_) * tiles_of(count);
    scene_.device().launch(find_, {std::max(1u, std::min(groups_, tile_pairs)), group_size_}, find);
}

} // namespace tandem
