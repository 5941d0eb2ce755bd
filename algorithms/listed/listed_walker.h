// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/broad_phase/broad_stage.h"
#include "algorithms/listed/body_motion.h"
#include "algorithms/tiled/tile_levels.h"

namespace tandem {

/// Keeps a list of pairs of tetrahedra from frame to frame, and walks again when the list may miss a pair.
/// The device decides this, so that every frame has the same commands: a walk that is not needed has no pairs
/// to begin with.
class ListedWalker final : public Walker {
public:
    /// Launches groups of `shape`. `trees` and `context` must outlive this object.
    ListedWalker(TileTrees& trees, const BuildContext& context, LaunchShape shape);

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status& status) override;
    void do_reset() override;
    void do_save_memory() override { drop_lists(); }
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    std::uint32_t request_of(const WalkTask& task);
    bool has_other_pairs(const WalkTask& task);
    void update_search();
    void search();
    bool grow_lists(const Status& status);
    void drop_lists();
    void launch_leaves(const WalkTask& task, const Buffer& body_pairs, std::uint32_t pair_capacity);
    void launch_answer(const WalkTask& task);
    Grid answer_grid();

    TileTrees& trees_;
    const Bodies& bodies_;
    Device& device_;
    TileLevels levels_;
    BodyMotion motion_;
    BroadStage search_;           ///< finds the body pairs of a list, by padded volumes
    bool is_sorted_ = false;      ///< search_ has an order of bodies
    std::uint64_t subdomain_ = 0; ///< TileTrees::changes() of the subdomain of search_
    GrowableBuffer body_pairs_;   ///< that search_ finds
    GrowableBuffer certain_;      ///< rows of two slots
    GrowableBuffer open_;         ///< the same, and in another column a word of directions
    std::uint64_t refits_ = 0;    ///< TileTrees::refits() of the last launch
    std::uint64_t changes_ = 0;   ///< TileTrees::changes() of the last launch
    std::vector<BodyPair> given_; ///< body pairs of the list, if they are given
    bool is_complete_ = false;    ///< its body pairs are not given, but found by search_
    bool searches_ = false;       ///< the last launch had a search
    bool is_known_ = false;    ///< the host has read how the last launch ended, and the list is not cut off
    bool has_memory_ = true;   ///< for lists; false until reset() after a list did not fit
    bool is_launched_ = false; ///< since the last grow()
    bool is_windowed_ = false;
    std::uint64_t rows_ = 0; ///< of teams in the last answer from a list
    ExpectedGroups groups_;
    Kernel leaf_kernel_, answer_kernel_;
};

} // namespace tandem
