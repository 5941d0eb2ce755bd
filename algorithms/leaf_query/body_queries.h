// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/chunk_trees.h"
#include "algorithms/leaf_query/body_query.cl.h"
#include "algorithms/pipeline/walker.h"

namespace tandem {

/// Every tetrahedron of the smaller body of a body pair queries the other body's tree (body_query.cl).
class BodyQueries final : public Walker {
public:
    /// `trees` must outlive this object; each body is one chunk. `has_self`: pairs may be of a body with
    /// itself.
    BodyQueries(const ChunkTrees& trees, LaunchShape shape, bool has_self);

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status&) override { return false; }
    std::optional<std::vector<Limit>> do_limits() const override { return std::vector<Limit>{}; }
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    const ChunkTrees& trees_;
    LaunchShape shape_;
    std::uint32_t blocks_; ///< turns of a work-group for the body pair with the most queries
    KernelOf<kernels::body_query::QueryLeaves> kernel_;
};

} // namespace tandem
