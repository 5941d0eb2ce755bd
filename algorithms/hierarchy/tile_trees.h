// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/hierarchy/hierarchy.h"
#include "algorithms/hierarchy/tile_shapes.h"

#include <optional>

namespace tandem {

/// Trees of tiles over every body's tetrahedra (tiles.clh): 32 boxes a tile, from which a level is made and
/// walked at once.
class TileTrees final : public Hierarchy {
public:
    /// `slabs`: what leaves have bounds along. `bodies`, of Sharing::by_mesh, must outlive this. Throws
    /// OutOfMemory when the tiles do not fit, DeviceError when there are too many to number.
    /// `most_seeds`: bodies begin below their tops where that makes no more pairs of tiles in all.
    /// `units_at_once`: so many groups of a refit the device runs side by side, at least. No bound depends on
    /// either.
    TileTrees(const Bodies& bodies, Slabs slabs, std::uint32_t group_size, std::uint64_t most_seeds,
              std::uint32_t units_at_once);
    TileTrees(const Bodies& bodies, Slabs slabs, std::uint32_t group_size, std::uint64_t most_seeds)
        : TileTrees(bodies, slabs, group_size, most_seeds, bodies.device().info().compute_units) {}

    const Bodies& bodies() const { return bodies_; }
    /// Of the highest body's tree.
    std::uint32_t levels() const { return static_cast<std::uint32_t>(level_first_.size()); }
    std::uint32_t levels_of(std::uint32_t body) const {
        return static_cast<std::uint32_t>(first_tiles_[body].size());
    }
    std::uint32_t first_tile(std::uint32_t body, std::uint32_t level) const {
        return first_tiles_[body][level];
    }
    /// Levels that are walked: where few bodies have few tiles below their tops, as many tiles are where they
    /// begin, for a level tells less there than its launch takes.
    std::uint32_t walked_levels() const { return beginnings_ ? beginnings_->level + 1 : levels(); }
    /// With how many tiles a body begins at that level; 0: no body does.
    std::uint32_t begins(std::uint32_t level) const;
    /// The first tile of level 1: how many there are of level 0.
    std::uint32_t first_upper() const { return level_first_.size() > 1 ? level_first_[1] : tile_count_; }
    /// What kernels that include tiles.clh are compiled with.
    Defines defines(std::uint32_t group_size) const;

    const Buffer& leaves() const {
        return leaves_;
    } ///< bounds of tetrahedra, a tile of level 0 after the other
    const Buffer& uppers() const { return uppers_; } ///< of the boxes of all other tiles, K words of 32 each
    const Buffer& roots() const { return roots_; }   ///< K reals a tile
    const Buffer& tile_table() const { return tile_table_; } ///< rows of tiles.clh
    const Buffer& tops() const { return tops_; }             ///< the tiles that bodies begin with, or NO_TILE
    const TileShapes& shapes() const { return shapes_; }

private:
    /// A row of tiles.clh.
    struct Tile {
        std::uint32_t body = 0, boxes = 0, item = 0, level_and_count = 0;
    };
    /// A row of refit_tiles.cl.
    struct Unit {
        std::uint32_t first = 0, count = 0, parent = 0, body = 0;
    };
    /// One launch of a refit: makes a level and the one above. Units of bodies that move come first.
    struct Step {
        std::uint32_t units = 0, moving_units = 0;
        Buffer table;
    };

    void do_refit(const Frame& frame, bool all) override;
    void do_take() override;
    const Buffer& do_volumes() const override { return volumes_; }
    const Buffer& do_nodes() const override { return leaves_; }
    std::size_t do_bytes() const override;

    void lay_out();
    void choose_beginnings(std::uint64_t most_seeds);
    std::vector<std::uint32_t> top_tiles() const;
    std::vector<Tile> tile_rows() const;
    void plan_refit();
    void add_units(std::uint32_t body, std::uint32_t level, std::uint32_t unit_tiles,
                   std::vector<Unit>& units) const;
    /// Of 32 leaf tiles each.
    std::uint32_t units_of_leaves() const;
    void upload_taking_part(const Frame& frame);
    void leave_out(const Frame& frame);
    std::uint32_t boxes_of(std::uint32_t body, std::uint32_t level) const;

    const Bodies& bodies_;
    Device& device_;
    Slabs slabs_;
    std::uint32_t group_size_;
    std::uint32_t units_at_once_;
    TileShapes shapes_;
    std::vector<std::uint32_t> level_first_; ///< the first tile of each level
    std::vector<bool> is_top_;               ///< by level: whether the tree of some body ends there
    /// Where all bodies begin when that is below some tops: with so many tiles each, or fewer.
    struct Beginnings {
        std::uint32_t level = 0, tiles = 1;
    };
    std::optional<Beginnings> beginnings_;
    std::vector<std::vector<std::uint32_t>> first_tiles_; ///< by body: its first tile of each of its levels
    std::uint32_t tile_count_ = 0;
    std::vector<Step> steps_;
    bool fresh_ = true; ///< fixed bodies need a refit: there was no frame yet, or it skipped others
    std::vector<std::vector<std::uint32_t>> skipped_; ///< by the last frame
    Buffer leaves_, uppers_, roots_, volumes_, tile_table_, tops_, taking_part_;
    Kernel leaf_kernel_, upper_kernel_;
};

} // namespace tandem
