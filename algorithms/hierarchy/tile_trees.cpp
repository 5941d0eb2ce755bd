// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/tile_trees.h"

#include "algorithms/bodies/self_pairs.h"
#include "algorithms/kernels/sources.h"
#include "backends/upload.h"

#include <algorithm>
#include <bit>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::uint32_t lanes = TileShapes::lanes;
constexpr std::uint32_t count_shift = 8;         ///< TILE_COUNT_SHIFT of tiles.clh
constexpr std::uint32_t tiles_a_turn = 8;        ///< TILES_A_TURN of refit_tiles.cl
constexpr std::uint32_t nothing = 0xffffffff;    ///< NO_TILE, NO_BODY
constexpr std::uint64_t most_tiles = 1ull << 27; ///< so that 32 bits can number their boxes

std::uint32_t in_tiles(std::uint32_t boxes) { return (boxes + lanes - 1) / lanes; }

/// Levels of a tree over `items` tetrahedra, including that of the top tile.
std::uint32_t levels_over(std::uint32_t items) {
    std::uint32_t levels = 1;
    for (auto boxes = items; boxes > lanes; boxes = in_tiles(boxes)) ++levels;
    return levels;
}

} // namespace

TileTrees::TileTrees(const Bodies& bodies, Slabs slabs, SelfPairs self, std::uint32_t group_size,
                     std::uint64_t most_seeds, std::uint32_t units_at_once)
    : bodies_(bodies),
      device_(bodies.device()),
      slabs_(slabs),
      group_size_(group_size),
      units_at_once_(units_at_once),
      shapes_(bodies),
      incidence_(bodies, self) {
    lay_out();
    limit_group_size();
    choose_beginnings(most_seeds, self);
    plan_refit();
    tile_table_ = uploaded(device_, bytes_of(tile_rows()), "tiles");
    tops_ = uploaded(device_, bytes_of(top_tiles()), "top tiles");
    const auto& geometry = bodies.geometry();
    const auto real = static_cast<std::uint64_t>(real_bytes(geometry));
    const auto k = static_cast<std::uint64_t>(ends_of_node(geometry));
    const auto leaf_words =
        slabs == Slabs::three ? std::min<std::uint64_t>(k, geometry.pressure_slab ? 8 : 6) : k;
    leaves_ = device_.allocate(first_upper() * leaf_words * lanes * real, "leaf tiles");
    uppers_ = device_.allocate(std::max<std::uint64_t>(1, tile_count_ - first_upper()) * k * lanes * real,
                               "upper tiles");
    roots_ = device_.allocate(tile_count_ * k * real, "roots of tiles");
    volumes_ = device_.allocate(bodies.count() * k * real, "volumes");
    taking_part_ = device_.allocate(std::uint64_t{first_upper()} * 4, "tetrahedra that take part");
    upload_taking_part({});
    const std::uint64_t marked = slabs_ == Slabs::touched ? first_upper() : 1;
    const std::vector<std::uint32_t> marks((marked + tiles_a_turn - 1) / tiles_a_turn * tiles_a_turn);
    marks_ = uploaded(device_, bytes_of(marks), "marks of tiles");
    compile_kernel(device_, leaf_kernel_, defines(group_size_));
    compile_kernel(device_, upper_kernel_, defines(group_size_));
    if (slabs_ == Slabs::touched) compile_kernel(device_, touched_kernel_, defines(group_size_));
}

Defines TileTrees::defines(std::uint32_t group_size) const {
    auto defines = geometry_defines(bodies_.geometry(), group_size);
    define(defines, parameters::slabs, slabs_ == Slabs::touched ? Slabs::all : slabs_);
    return defines;
}

/// Boxes of a body's level. At level 0 these are its tetrahedra.
std::uint32_t TileTrees::boxes_of(std::uint32_t body, std::uint32_t level) const {
    auto boxes = bodies_.row(body).tetrahedron_count;
    for (; level > 0; --level) boxes = in_tiles(boxes);
    return boxes;
}

/// Numbers tiles level by level, with bodies in the order of their slots. A tile of level 0 is then a block
/// of slots.
void TileTrees::lay_out() {
    first_tiles_.resize(bodies_.count());
    std::uint64_t count = 0;
    for (std::uint32_t level = 0; level == level_first_.size(); ++level) {
        const auto first = count;
        for (const auto body : bodies_.slot_order()) {
            if (level >= levels_over(bodies_.row(body).tetrahedron_count)) continue;
            first_tiles_[body].push_back(static_cast<std::uint32_t>(count));
            count += in_tiles(boxes_of(body, level));
            if (count > most_tiles)
                throw DeviceError(fmt::format("scene: more than {} tiles of {} boxes; leave bodies out",
                                              most_tiles, lanes));
        }
        if (count > first) level_first_.push_back(static_cast<std::uint32_t>(first));
    }
    tile_count_ = static_cast<std::uint32_t>(count);
    is_top_.resize(levels());
    for (const auto& first : first_tiles_) is_top_[first.size() - 1] = true;
}

/// A group has no more teams than any unit has tiles: bodies of two tiles are refitted in twice as many
/// groups at once as with four teams.
void TileTrees::limit_group_size() {
    std::uint32_t most = 1;
    for (std::uint32_t body = 0; body < bodies_.count(); ++body)
        most = std::max(most, std::min(boxes_of(body, 1), lanes));
    if (group_size_ > lanes) group_size_ = std::min(group_size_, std::bit_ceil(most) * lanes);
}

/// Selects the lowest level that all bodies have and whose tile pairs are few enough to test without the
/// levels above.
void TileTrees::choose_beginnings(std::uint64_t most_seeds, SelfPairs self) {
    const auto pairs = most_body_pairs(bodies_.scene(), self);
    for (std::uint32_t level = 0; level + 1 < levels(); ++level) {
        std::uint64_t tiles = 1;
        for (std::uint32_t body = 0; body < bodies_.count(); ++body) {
            if (levels_of(body) <= level) return;
            tiles = std::max<std::uint64_t>(tiles, boxes_of(body, level + 1));
        }
        if (pairs > most_seeds / (tiles * tiles)) continue;
        beginnings_ = {level, static_cast<std::uint32_t>(tiles)};
        return;
    }
}

std::uint32_t TileTrees::begins(std::uint32_t level) const {
    if (beginnings_) return level == beginnings_->level ? beginnings_->tiles : 0;
    return is_top_[level] ? 1 : 0;
}

std::vector<std::uint32_t> TileTrees::top_tiles() const {
    std::vector<std::uint32_t> tops;
    for (std::uint32_t body = 0; body < bodies_.count(); ++body) {
        const auto top = Beginnings{levels_of(body) - 1, 1};
        const auto& [level, most] = beginnings_.value_or(top);
        const auto tiles = boxes_of(body, level + 1);
        for (std::uint32_t tile = 0; tile < most; ++tile)
            tops.push_back(tile < tiles ? first_tile(body, level) + tile : nothing);
    }
    return tops;
}

std::vector<TileTrees::Tile> TileTrees::tile_rows() const {
    std::vector<Tile> rows(tile_count_);
    for (std::uint32_t body = 0; body < bodies_.count(); ++body) {
        const auto& first = first_tiles_[body];
        const auto shapes = shapes_.first_row(bodies_.scene().bodies[body].mesh);
        std::uint32_t items = lanes; // tetrahedra below a tile of the level
        for (std::uint32_t level = 0; level < first.size(); ++level, items *= lanes) {
            const auto boxes = boxes_of(body, level);
            for (std::uint32_t tile = 0; tile < in_tiles(boxes); ++tile) {
                const auto count = std::min(lanes, boxes - tile * lanes);
                const auto below = level == 0 ? shapes + tile : first[level - 1] + tile * lanes;
                rows[first[level] + tile] = {body, below, tile * items, level | count << count_shift};
            }
        }
    }
    return rows;
}

/// Adds the units of one body that build `level`, of `unit_tiles` tiles each. Units of 32 tiles also build
/// the level above.
void TileTrees::add_units(std::uint32_t body, std::uint32_t level, std::uint32_t unit_tiles,
                          std::vector<Unit>& units) const {
    const auto& first = first_tiles_[body];
    if (level >= first.size()) return;
    const auto tiles = in_tiles(boxes_of(body, level));
    const std::uint32_t made = unit_tiles == lanes ? 2 : 1; // levels that a unit builds
    const bool has_parents = made == 2 && level + 1 < first.size();
    const bool is_whole = level + made >= first.size();
    for (std::uint32_t unit = 0; unit * unit_tiles < tiles; ++unit)
        units.push_back({first[level] + unit * unit_tiles, std::min(unit_tiles, tiles - unit * unit_tiles),
                         has_parents ? first[level + 1] + unit : nothing, is_whole ? body : nothing});
}

std::uint32_t TileTrees::units_of_leaves() const {
    std::uint64_t units = 0;
    for (std::uint32_t body = 0; body < bodies_.count(); ++body)
        if (is_active(body)) units += in_tiles(boxes_of(body, 1));
    return static_cast<std::uint32_t>(units);
}

/// Each step builds two levels. If the units of the lowest two would leave most of the device idle, leaves
/// are a separate step. Its units have one tile for each team of a group, so that no team builds several
/// tiles in sequence.
void TileTrees::plan_refit() {
    few_units_ = units_of_leaves() < units_at_once_;
    std::uint32_t unit_tiles = few_units_ ? std::max(1u, group_size_ / lanes) : lanes;
    for (std::uint32_t level = 0; level < levels(); level += unit_tiles == lanes ? 2 : 1) {
        if (level > 0) unit_tiles = lanes;
        std::vector<Unit> units;
        Step step;
        for (const auto body : bodies_.slot_order()) {
            if (!is_active(body)) continue;
            add_units(body, level, unit_tiles, units);
            if (!bodies_.scene().bodies[body].fixed)
                step.moving_units = static_cast<std::uint32_t>(units.size());
        }
        step.units = static_cast<std::uint32_t>(units.size());
        if (units.empty()) units.emplace_back(); // buffers cannot be empty
        step.table = uploaded(device_, bytes_of(units), "units of a refit");
        steps_.push_back(std::move(step));
    }
}

void TileTrees::do_take(const Subdomain&) {
    steps_.clear();
    plan_refit();
    fresh_ = true;
}

std::size_t TileTrees::do_bytes() const {
    auto sum = shapes_.bytes() + incidence_.bytes();
    for (const auto* buffer :
         {&leaves_, &uppers_, &roots_, &volumes_, &tile_table_, &tops_, &taking_part_, &marks_})
        sum += buffer->bytes();
    for (const auto& step : steps_) sum += step.table.bytes();
    return sum;
}

/// Uploads a bit for every tetrahedron: whether it exists and the frame does not skip it.
void TileTrees::upload_taking_part(const Frame& frame) {
    std::vector<std::uint32_t> words(first_upper());
    {
        const HostWork work(device_, Stage::preprocess, "skipped tetrahedra");
        for (std::uint32_t body = 0; body < bodies_.count(); ++body) {
            const auto items = bodies_.row(body).tetrahedron_count;
            const auto first = first_tiles_[body][0];
            for (std::uint32_t item = 0; item < items; ++item)
                words[first + item / lanes] |= 1u << item % lanes;
            if (frame.skipped.empty() || frame.skipped[body].empty()) continue;
            for (const auto item : bodies_.positions_of(body, frame.skipped[body]))
                words[first + item / lanes] &= ~(1u << item % lanes);
        }
    }
    const StageScope scope(device_, Stage::write);
    device_.upload(taking_part_, bytes_of(words));
}

void TileTrees::mask_skipped(const Frame& frame) {
    if (frame.skipped == skipped_) return;
    upload_taking_part(frame);
    skipped_ = frame.skipped;
    fresh_ = true;
}

/// A refit that stores no leaves reads the vertices of touched tiles twice, which pays if these are few. They
/// are about half of all tiles at the limit: with 0.4, 0.9 and 3.7 pairs a tile, 22, 36 and 80 % were touched
/// (H100, 2,000 bodies). Bodies that start with several tiles of level 0 touch these without a mark.
bool TileTrees::stores_leaves() const {
    const bool marks_all = !beginnings_ || beginnings_->level > 0;
    return slabs_ != Slabs::touched || few_units_ || !marks_all
           || expected_pairs_ >= first_upper() + first_upper() / 2;
}

/// Runs bottom up, two levels per launch.
void TileTrees::do_refit(const Frame& frame, bool all) {
    mask_skipped(frame);
    const bool stores = stores_leaves();
    all |= fresh_ || (stores && !stored_);
    stored_ = stores;
    const StageScope scope(device_, Stage::refit);
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        const auto& step = steps_[i];
        const Grid grid{all ? step.units : step.moving_units, group_size_};
        if (grid.groups == 0) continue;
        if (i == 0) {
            const kernels::refit_tiles::RefitLeafTiles arguments{.leaves = leaves_,
                                                                 .uppers = uppers_,
                                                                 .first_upper = first_upper(),
                                                                 .roots = roots_,
                                                                 .volumes = volumes_,
                                                                 .units = step.table,
                                                                 .tiles = tile_table_,
                                                                 .taking_part = taking_part_,
                                                                 .starts = shapes_.starts(),
                                                                 .vertex_numbers = shapes_.vertex_numbers(),
                                                                 .corners = shapes_.corners(),
                                                                 .bodies = bodies_.row_table(),
                                                                 .poses = bodies_.poses(),
                                                                 .vertices = bodies_.vertices(),
                                                                 .next_poses = bodies_.next_poses(),
                                                                 .next_vertices = bodies_.next_vertices(),
                                                                 .margin =
                                                                     reach_of_margin(bodies_.geometry()),
                                                                 .stored = std::uint32_t{stores ? 1u : 0u}};
            device_.launch(leaf_kernel_, grid, arguments);
        } else {
            const kernels::refit_tiles::RefitUpperTiles arguments{.uppers = uppers_,
                                                                  .first_upper = first_upper(),
                                                                  .roots = roots_,
                                                                  .volumes = volumes_,
                                                                  .units = step.table,
                                                                  .tiles = tile_table_};
            device_.launch(upper_kernel_, grid, arguments);
        }
    }
    fresh_ = false;
}

void TileTrees::bound_touched() const {
    const StageScope scope(device_, Stage::refit);
    const std::uint32_t tiles = std::max(1u, group_size_ / lanes) * tiles_a_turn; // of a group, or more
    const kernels::refit_tiles::BoundTouchedTiles arguments{.leaves = leaves_,
                                                            .marks = marks_,
                                                            .tile_count = first_upper(),
                                                            .tiles = tile_table_,
                                                            .taking_part = taking_part_,
                                                            .starts = shapes_.starts(),
                                                            .vertex_numbers = shapes_.vertex_numbers(),
                                                            .corners = shapes_.corners(),
                                                            .bodies = bodies_.row_table(),
                                                            .poses = bodies_.poses(),
                                                            .vertices = bodies_.vertices(),
                                                            .next_poses = bodies_.next_poses(),
                                                            .next_vertices = bodies_.next_vertices(),
                                                            .margin = reach_of_margin(bodies_.geometry())};
    device_.launch(touched_kernel_, {(first_upper() + tiles - 1) / tiles, group_size_}, arguments);
}

} // namespace tandem
