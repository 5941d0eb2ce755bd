// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/scene_tree.h"
#include "algorithms/leaf_query/partner_lists.h"
#include "algorithms/leaf_query/scene_query.cl.h"
#include "algorithms/pipeline/walker.h"

namespace tandem {

/// Every tetrahedron of a scene queries one tree over all bodies (scene_query.cl). Body pairs that are not
/// all of the scene's are respected by a list of partners of each body.
class SceneQueries final : public Walker {
public:
    /// `tree` must outlive this object.
    SceneQueries(SceneTree& tree, LaunchShape shape);

private:
    void do_compile(const WalkBuild& build) override;
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status&) override { return false; }
    std::optional<std::vector<Limit>> do_limits() const override { return std::vector<Limit>{}; }
    void do_reset() override { tree_.build_next(); }
    void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const override;

    SceneTree& tree_;
    LaunchShape shape_;
    Buffer filters_;
    PartnerLists partners_;
    KernelOf<kernels::scene_query::QueryScene> kernel_;
};

} // namespace tandem
