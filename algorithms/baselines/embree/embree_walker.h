// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/baselines/embree/embree_trees.h"

namespace tandem {

/// Calls rtcCollide for each body pair; leaf tests and answers are the project's own.
class EmbreeWalker final : public Walker {
public:
    /// `trees` must outlive this object.
    EmbreeWalker(EmbreeTrees& trees, const BuildContext& context);

    /// Kernel collide_embree. `body_pairs` has `pair_capacity` rows.
    static void run(const std::uint32_t* body_pairs, std::uint32_t pair_capacity, std::uint32_t* found,
                    std::uint32_t capacity, std::uint32_t* status, const EmbreeWalker* walker);

private:
    /// A body pair, and the output for its candidate pairs.
    struct PairTask;

    void do_compile(const WalkBuild& build) override { build_ = build; }
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status&) override { return false; }
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    template<bool tolerant>
    static void test_leaves(void* task, RTCCollision* collisions, unsigned count);

    EmbreeTrees& trees_;
    RTCCollideFunc leaf_test_;
    WalkBuild build_;
    Kernel kernel_;
    Buffer self_; ///< this object, as an argument of the kernel
};

} // namespace tandem
