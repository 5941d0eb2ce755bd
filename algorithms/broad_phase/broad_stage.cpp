// SPDX-License-Identifier: MIT
#include "algorithms/broad_phase/broad_stage.h"

#include "algorithms/broad_phase/filters.h"
#include "algorithms/broad_phase/tile.clh"
#include "algorithms/bodies/ball.h"
#include "algorithms/bodies/self_pairs.h"
#include "algorithms/parameters/table.h"
#include "algorithms/kernels/sources.h"
#include "backends/upload.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::uint32_t most_bodies = (1u << 15) * BROAD_TILE; ///< 2^30 pairs of tiles, numbered by 32 bits

std::uint32_t tiles_of(std::uint32_t bodies) { return (bodies + BROAD_TILE - 1) / BROAD_TILE; }

/// First and last world of the bodies in a tile.
struct Worlds {
    std::uint32_t first = 0, last = 0;

    bool has_common(const Worlds& other) const { return first <= other.last && other.first <= last; }
};

std::vector<Worlds> worlds_of_tiles(const Scene& scene, const std::vector<std::uint32_t>& order) {
    std::vector<Worlds> tiles;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const auto world = world_of(scene, order[i]);
        if (i % BROAD_TILE == 0) tiles.push_back({world, world});
        tiles.back().first = std::min(tiles.back().first, world);
        tiles.back().last = std::max(tiles.back().last, world);
    }
    return tiles;
}

} // namespace

BroadStage::BroadStage(const Bodies& bodies, const Buffer& volumes, LaunchShape shape, SelfPairs self)
    : bodies_(bodies), volumes_(volumes), self_(self) {
    shape_.group_size = std::min<std::uint32_t>(shape.group_size, BROAD_TILE);
    shape_.groups = shape.groups * (shape.group_size / shape_.group_size);
    const auto count = bodies.count();
    const bool has_worlds = bodies.scene().world_size != 0;
    if (count > most_bodies && !has_worlds)
        throw InputError(fmt::format("setting broad=device takes at most {} bodies and the scene has {}; "
                                     "choose broad=tight",
                                     most_bodies, count));
    for (const auto& mesh : bodies.scene().meshes) mesh_centres_.push_back(box_centre(mesh.vertices));
    auto& device = bodies.device();
    const auto& geometry = bodies.geometry();
    auto defines = geometry_defines(geometry, shape_.group_size);
    define(defines, parameters::self, self);
    if (has_filters(bodies.scene())) defines["FILTERED"] = "1";
    if (has_worlds) defines["WORLDS"] = "1";
    if (tiles_of(count) > 1) compile_kernel(device, bound_, defines);
    compile_kernel(device, find_, defines);
    const auto volume = static_cast<std::uint64_t>(ends_of_node(geometry)) * real_bytes(geometry);
    order_ = device.allocate(std::uint64_t{count} * 4, "order of bodies");
    roots_ = device.allocate(count * volume, "root volumes");
    unions_ = device.allocate(tiles_of(count) * volume, "unions of tiles");
    filters_ = uploaded_filters(device, bodies.scene());
    list_ = device.allocate(4, "pairs of tiles of bodies");
}

std::uint64_t BroadStage::most_pairs() const { return most_body_pairs(bodies_.scene(), self_); }

std::vector<Eigen::Vector3d> BroadStage::centres(const Frame& frame) const {
    std::vector<Eigen::Vector3d> centres;
    const auto& bodies = bodies_.scene().bodies;
    for (std::size_t body = 0; body < bodies.size(); ++body) {
        const auto& pose = frame.poses[body];
        centres.push_back(bodies[body].deformable
                              ? box_centre(frame.deformed[body])
                              : pose.rotation.normalized() * mesh_centres_[bodies[body].mesh]
                                    + pose.translation);
    }
    return centres;
}

/// Centres of the volumes along the first three directions, which are linearly independent.
template<class Real>
std::vector<Eigen::Vector3d> BroadStage::centres_of_volumes() const {
    const auto k = static_cast<std::size_t>(ends_of_node(bodies_.geometry()));
    std::vector<Real> slabs(bodies_.count() * k);
    {
        const StageScope scope(bodies_.device(), Stage::read);
        bodies_.device().download(volumes_, std::as_writable_bytes(std::span(slabs)));
    }
    std::vector<Eigen::Vector3d> centres(bodies_.count());
    for (std::size_t body = 0; body < centres.size(); ++body)
        for (std::size_t i = 0; i < 3; ++i) {
            const auto lower = static_cast<double>(slabs[body * k + i]);
            const auto upper = static_cast<double>(slabs[body * k + k / 2 + i]);
            centres[body][static_cast<Eigen::Index>(i)] = 0.5 * (lower + upper);
        }
    return centres;
}

void BroadStage::sort(const Frame& frame) { sort(centres(frame)); }

void BroadStage::sort_by_volumes() {
    sort(bodies_.geometry().precision == Precision::fp64 ? centres_of_volumes<double>()
                                                         : centres_of_volumes<float>());
}

void BroadStage::sort(const std::vector<Eigen::Vector3d>& centres) {
    std::vector<std::uint32_t> order;
    {
        const HostWork work(bodies_.device(), Stage::broad, "sort bodies");
        order = morton_order(centres);
        const auto moving = [&](std::uint32_t body) { return !bodies_.scene().bodies[body].fixed; };
        const auto fixed = std::stable_partition(order.begin(), order.end(), moving);
        moving_count_ = static_cast<std::uint32_t>(fixed - order.begin());
    }
    upload(order);
}

void BroadStage::set_subdomain(const Subdomain& subdomain) {
    auto order = subdomain.own;
    order.insert(order.end(), subdomain.ghosts.begin(), subdomain.ghosts.end());
    moving_count_ = static_cast<std::uint32_t>(subdomain.own.size());
    upload(order);
}

/// The bodies of each world follow each other among those that move, and among the others. So tiles have
/// bodies of few worlds.
void BroadStage::upload(std::vector<std::uint32_t> order) {
    count_ = static_cast<std::uint32_t>(order.size());
    if (order.empty()) return;
    const auto& scene = bodies_.scene();
    if (scene.world_size != 0) {
        const auto by_world = [&](std::uint32_t a, std::uint32_t b) {
            return world_of(scene, a) < world_of(scene, b);
        };
        std::stable_sort(order.begin(), order.begin() + moving_count_, by_world);
        std::stable_sort(order.begin() + moving_count_, order.end(), by_world);
        list_tile_pairs(order);
    }
    const StageScope scope(bodies_.device(), Stage::write);
    bodies_.device().upload(order_, bytes_of(order));
}

/// Lists the pairs row <= column of a tile with moving bodies and one with bodies of the same world. Worlds
/// ascend from tile to tile, first among tiles with moving bodies, of which the last may have others, then
/// among the rest.
void BroadStage::list_tile_pairs(const std::vector<std::uint32_t>& order) {
    const auto tiles = worlds_of_tiles(bodies_.scene(), order);
    const auto end = static_cast<std::uint32_t>(tiles.size());
    const auto rows = tiles_of(moving_count_);
    std::vector<std::uint32_t> list;
    for (std::uint32_t row = 0; row < rows; ++row) {
        const auto add = [&](std::uint32_t column) {
            if (tiles[row].has_common(tiles[column])) list.insert(list.end(), {row, column});
        };
        auto column = row;
        for (; column + 1 < rows && tiles[column].first <= tiles[row].last; ++column) add(column);
        add(rows - 1);
        const auto fixed =
            std::ranges::lower_bound(tiles.begin() + rows, tiles.end(), tiles[row].first, {}, &Worlds::last);
        for (column = static_cast<std::uint32_t>(fixed - tiles.begin());
             column < end && tiles[column].first <= tiles[row].last; ++column)
            add(column);
    }
    listed_ = static_cast<std::uint32_t>(list.size() / 2);
    list_ = uploaded(bodies_.device(), bytes_of(list), "pairs of tiles of bodies");
}

void BroadStage::launch(const Buffer& pairs, std::uint32_t capacity, const Buffer& status) {
    const StageScope scope(bodies_.device(), Stage::broad);
    if (tiles_of(count_) > 1) {
        const kernels::broad::BoundTiles bound{
            .volumes = volumes_, .order = order_, .body_count = count_, .roots = roots_, .unions = unions_};
        bodies_.device().launch(bound_, {tiles_of(count_), shape_.group_size}, bound);
    }
    const kernels::broad::FindBodyPairs find{.volumes = volumes_,
                                             .roots = roots_,
                                             .unions = unions_,
                                             .order = order_,
                                             .bodies = bodies_.row_table(),
                                             .filters = filters_,
                                             .body_count = count_,
                                             .moving_count = moving_count_,
                                             .list = list_,
                                             .listed = listed_,
                                             .pairs = pairs,
                                             .capacity = capacity,
                                             .status = status};
    const auto tile_pairs =
        bodies_.scene().world_size != 0 ? listed_ : tiles_of(moving_count_) * tiles_of(count_);
    bodies_.device().launch(find_, {std::max(1u, std::min(shape_.groups, tile_pairs)), shape_.group_size},
                            find);
}

} // namespace tandem
