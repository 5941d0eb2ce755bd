// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/hierarchy/hierarchy.h"
#include "algorithms/hierarchy/refit_tiles.cl.h"
#include "algorithms/hierarchy/tile_incidence.h"
#include "algorithms/hierarchy/tile_shapes.h"

#include <optional>

namespace tandem {

/// Trees of tiles over every body's tetrahedra (tiles.clh). A tile has 32 boxes, which a team builds and
/// tests together.
class TileTrees final : public Hierarchy {
public:
    /// `slabs`: directions of the bounds of leaves. `bodies` must have Sharing::by_mesh and outlive this
    /// object. `self`: which bodies are in pairs with themselves. `most_seeds`: maximum number of tile pairs
    /// for which bodies start below their tops, if a frame repeats no body pair. `units_at_once`: minimum
    /// number of refit groups that the device runs concurrently. Neither changes any bound. Throws
    /// OutOfMemory when the tiles do not fit, DeviceError when there are too many to number.
    TileTrees(const Bodies& bodies, Slabs slabs, SelfPairs self, std::uint32_t group_size,
              std::uint64_t most_seeds, std::uint32_t units_at_once);
    TileTrees(const Bodies& bodies, Slabs slabs, SelfPairs self, std::uint32_t group_size,
              std::uint64_t most_seeds)
        : TileTrees(bodies, slabs, self, group_size, most_seeds, bodies.device().info().compute_units) {}

    const Bodies& bodies() const { return bodies_; }
    /// Levels of the highest tree.
    std::uint32_t levels() const { return static_cast<std::uint32_t>(level_first_.size()); }
    std::uint32_t levels_of(std::uint32_t body) const {
        return static_cast<std::uint32_t>(first_tiles_[body].size());
    }
    std::uint32_t first_tile(std::uint32_t body, std::uint32_t level) const {
        return first_tiles_[body][level];
    }
    /// Number of levels to walk. If few bodies have few tiles below their tops, the walk starts there,
    /// because the levels above prune less than their launches cost.
    std::uint32_t walked_levels() const { return beginnings_ ? beginnings_->level + 1 : levels(); }
    /// Maximum number of tiles with which a body starts at `level`; 0 if no body starts there.
    std::uint32_t begins(std::uint32_t level) const;
    /// The first tile of level 1, which equals the number of tiles of level 0.
    std::uint32_t first_upper() const { return level_first_.size() > 1 ? level_first_[1] : tile_count_; }
    /// Defines for kernels that include tiles.clh.
    Defines defines(std::uint32_t group_size) const;

    /// Pairs of tiles of level 0 that the last frame tested. With few of them and Slabs::touched, the next
    /// refit leaves the bounds of tetrahedra to bound_touched().
    void expect_tile_pairs(std::uint64_t pairs) { expected_pairs_ = pairs; }
    /// Whether the walk shall mark tiles of level 0, one word each, and call bound_touched().
    bool has_touched() const { return !stored_; }
    const Buffer& marks() const { return marks_; }
    /// Enqueues the bounds of the tetrahedra of all marked tiles, and clears the marks.
    void bound_touched() const;

    /// Bounds of tetrahedra, one tile of level 0 after the other.
    const Buffer& leaves() const { return leaves_; }
    const Buffer& uppers() const { return uppers_; }         ///< boxes of all other tiles, K words of 32 each
    const Buffer& roots() const { return roots_; }           ///< K reals per tile
    const Buffer& tile_table() const { return tile_table_; } ///< rows of tiles.clh
    const Buffer& tops() const { return tops_; }             ///< tiles that bodies start with, or NO_TILE
    const TileShapes& shapes() const { return shapes_; }
    const TileIncidence& incidence() const { return incidence_; }

private:
    /// A row of the tile table (tiles.clh).
    struct Tile {
        std::uint32_t body = 0, boxes = 0, item = 0, level_and_count = 0;
    };
    /// A row of the unit table (refit_tiles.cl).
    struct Unit {
        std::uint32_t first = 0, count = 0, parent = 0, body = 0;
    };
    /// One launch of a refit, which builds up to two levels. Units of moving bodies come first.
    struct Step {
        std::uint32_t units = 0, moving_units = 0;
        Buffer table;
    };

    void do_refit(const Frame& frame, bool all) override;
    void do_take(const Subdomain&) override;
    const Buffer& do_volumes() const override { return volumes_; }
    const Buffer& do_nodes() const override { return leaves_; }
    std::size_t do_bytes() const override;

    void lay_out();
    void limit_group_size();
    void choose_beginnings(std::uint64_t most_seeds, SelfPairs self);
    std::vector<std::uint32_t> top_tiles() const;
    std::vector<Tile> tile_rows() const;
    void plan_refit();
    void add_units(std::uint32_t body, std::uint32_t level, std::uint32_t unit_tiles,
                   std::vector<Unit>& units) const;
    /// Number of units of 32 leaf tiles each.
    std::uint32_t units_of_leaves() const;
    void upload_taking_part(const Frame& frame);
    void mask_skipped(const Frame& frame);
    bool stores_leaves() const;
    std::uint32_t boxes_of(std::uint32_t body, std::uint32_t level) const;

    static constexpr std::uint64_t most_pairs_unknown = ~std::uint64_t{0};

    const Bodies& bodies_;
    Device& device_;
    Slabs slabs_;
    std::uint32_t group_size_;
    std::uint32_t units_at_once_;
    TileShapes shapes_;
    TileIncidence incidence_;
    std::vector<std::uint32_t> level_first_; ///< the first tile of each level
    std::vector<bool> is_top_;               ///< by level: whether it is the top of some body's tree
    /// Common start of all bodies, if it is below some tops: a level and the maximum number of tiles per
    /// body.
    struct Beginnings {
        std::uint32_t level = 0, tiles = 1;
    };
    std::optional<Beginnings> beginnings_;
    std::vector<std::vector<std::uint32_t>> first_tiles_; ///< [body][level]: the first tile
    std::uint32_t tile_count_ = 0;
    std::vector<Step> steps_;
    std::uint64_t expected_pairs_ = most_pairs_unknown;
    bool few_units_ = false;                          ///< whether leaves are a step of their own
    bool stored_ = true;                              ///< whether the last refit stored all leaves
    bool fresh_ = true;                               ///< whether the next refit includes fixed bodies
    std::vector<std::vector<std::uint32_t>> skipped_; ///< by body: tetrahedra that the last frame skips
    Buffer leaves_, uppers_, roots_, volumes_, tile_table_, tops_, taking_part_, marks_;
    KernelOf<kernels::refit_tiles::RefitLeafTiles> leaf_kernel_;
    KernelOf<kernels::refit_tiles::RefitUpperTiles> upper_kernel_;
    KernelOf<kernels::refit_tiles::BoundTouchedTiles> touched_kernel_; ///< null unless slabs=touched
};

} // namespace tandem
