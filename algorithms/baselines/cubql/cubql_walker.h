// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/baselines/cubql/cubql_trees.h"

namespace tandem {

/// Queries of the tetrahedra of one body against cuBQL's tree of the other, for all body pairs in one launch.
class CubqlWalker final : public Walker {
public:
    /// `trees` must outlive this object.
    CubqlWalker(CubqlTrees& trees, const BuildContext& context);

private:
    void do_compile(const WalkBuild& build) override { build_ = build; }
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status&) override { return false; }
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    CubqlTrees& trees_;
    std::uint32_t parts_; ///< turns of a work-group for the body pair with the most queries
    WalkBuild build_;
    Kernel kernel_;
};

} // namespace tandem
