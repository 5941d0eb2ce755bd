// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/scene_tree.h"

#include "algorithms/bodies/self_pairs.h"
#include "algorithms/orders/heap.h"
#include "algorithms/kernels/sources.h"

#include <algorithm>
#include <numeric>

namespace tandem {

namespace {

// Words of scene_tree.clh.
constexpr std::uint32_t passive = 0x80000000, meets_itself_flag = 0x80000000;
constexpr std::uint32_t box_items = 8;
constexpr std::size_t state_words = 2, row_words = 4;

/// Numbers of boxes by level, from level 1 up.
std::vector<std::uint32_t> box_levels(std::uint32_t leaves) {
    std::vector<std::uint32_t> levels;
    for (auto count = leaves; count > box_items; levels.push_back(count))
        count = (count + box_items - 1) / box_items;
    return levels;
}

std::uint64_t sum(const std::vector<std::uint32_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

std::uint32_t tetrahedra_of(const Bodies& bodies) {
    std::uint64_t all = 0;
    for (std::uint32_t body = 0; body < bodies.count(); ++body) all += bodies.row(body).tetrahedron_count;
    if (all >= std::uint64_t{1} << 31)
        throw DeviceError("setting tree=scene: 2^31 tetrahedra or more; leave bodies out, or choose "
                          "tree=body");
    return static_cast<std::uint32_t>(all);
}

} // namespace

SceneTree::SceneTree(const Bodies& bodies, LaunchShape shape, SelfPairs self, std::uint32_t period)
    : trees_(bodies, ChunkTrees::one_chunk_a_body, shape.group_size),
      device_(bodies.device()),
      shape_(shape),
      self_(self),
      period_(period) {
    const auto most = std::max(1u, tetrahedra_of(bodies)); // buffers cannot be empty
    const auto node =
        static_cast<std::uint64_t>(ends_of_node(bodies.geometry())) * real_bytes(bodies.geometry());
    const auto row = row_words * 4;
    const auto boxes = std::max<std::uint64_t>(1, sum(box_levels(most)));
    rows_ = device_.allocate(most * row, "tetrahedra of the scene");
    body_list_ = device_.allocate(bodies.count() * std::size_t{4}, "bodies of the scene");
    region_ = device_.allocate(4 * real_bytes(bodies.geometry()), "region of the scene");
    state_ = device_.allocate(state_words * 4, "state of the scene's tree");
    leaves_ = device_.allocate(most * row, "leaves of the scene's tree");
    inner_ = device_.allocate(most * row, "inner nodes of the scene's tree");
    leaf_bounds_ = device_.allocate(most * node, "bounds of leaves");
    inner_bounds_ = device_.allocate(most * node, "bounds of inner nodes");
    boxes_ = device_.allocate(boxes * node, "boxes of leaves");
    box_owners_ = device_.allocate(boxes * row, "owners of boxes");
    sort_.emplace(device_, shape_, most);
    const auto own = defines(shape_.group_size);
    compile_kernel(device_, begin_, own);
    compile_kernel(device_, code_, own);
    compile_kernel(device_, link_, own);
    compile_kernel(device_, copy_, own);
    compile_kernel(device_, boxes_kernel_, own);
    compile_kernel(device_, inner_kernel_, own);
    upload_rows();
}

/// Whether no pair needs this body unless the other one is active.
bool SceneTree::is_passive(std::uint32_t body) const {
    if (!subdomain_) return bodies().scene().bodies[body].fixed;
    return !std::ranges::binary_search(subdomain_->own, body);
}

/// Uploads the rows of all tetrahedra in the order of bodies.
void SceneTree::upload_rows() {
    std::vector<LeafRow> rows;
    std::vector<std::uint32_t> list;
    for (std::uint32_t body = 0; body < bodies().count(); ++body) {
        const auto items = bodies().row(body).tetrahedron_count;
        if (!is_active(body) || items == 0) continue;
        const auto owner = body | (is_passive(body) ? passive : 0);
        const auto flag =
            meets_itself(bodies().scene(), body, self_) && !is_passive(body) ? meets_itself_flag : 0;
        for (std::uint32_t item = 0; item < items; ++item)
            rows.push_back({trees_.first_slot(body) + heap::leaf_node(item, items), owner, item | flag});
        list.push_back(body);
    }
    count_ = static_cast<std::uint32_t>(rows.size());
    body_count_ = static_cast<std::uint32_t>(list.size());
    builds_next_ = true;
    const StageScope scope(device_, Stage::write);
    if (rows.empty()) return;
    device_.upload(rows_, bytes_of(rows));
    device_.upload(body_list_, bytes_of(list));
}

void SceneTree::do_take(const Subdomain& subdomain) {
    trees_.take(subdomain, bodies().count());
    subdomain_ = subdomain;
    std::ranges::sort(subdomain_->own);
    upload_rows();
}

std::size_t SceneTree::do_bytes() const {
    std::size_t all = trees_.bytes() + sort_->bytes();
    for (const auto* buffer : {&rows_, &body_list_, &region_, &state_, &leaves_, &inner_, &leaf_bounds_,
                               &inner_bounds_, &boxes_, &box_owners_})
        all += buffer->bytes();
    return all;
}

Grid SceneTree::grid(std::uint64_t items) const {
    const auto groups = (items + shape_.group_size - 1) / shape_.group_size;
    return {std::min<std::uint64_t>(groups, shape_.groups), shape_.group_size};
}

void SceneTree::build() {
    const kernels::scene_build::BeginBuild begin{.volumes = trees_.volumes(),
                                                 .bodies = body_list_,
                                                 .body_count = body_count_,
                                                 .request = std::uint32_t{builds_next_ ? 1u : 0u},
                                                 .period = period_,
                                                 .state = state_,
                                                 .region = region_};
    device_.launch(begin_, {1, shape_.group_size}, begin);
    const kernels::scene_build::CodeLeaves code{.rows = rows_,
                                                .count = count_,
                                                .nodes = trees_.nodes(),
                                                .region = region_,
                                                .state = state_,
                                                .keys = sort_->keys(),
                                                .values = sort_->values()};
    device_.launch(code_, grid(count_), code);
    sort_->launch(count_, state_);
    const kernels::scene_build::LinkNodes link{.keys = sort_->keys(),
                                               .values = sort_->values(),
                                               .rows = rows_,
                                               .count = count_,
                                               .state = state_,
                                               .leaves = leaves_,
                                               .inner = inner_};
    device_.launch(link_, grid(count_), link);
    builds_next_ = false;
}

/// Two levels of boxes a launch, after the lowest, which has a launch of its own: it reads the most.
void SceneTree::bound() {
    const kernels::scene_bounds::CopyLeafBounds copy{
        .nodes = trees_.nodes(), .leaves = leaves_, .count = count_, .bounds = leaf_bounds_};
    device_.launch(
        copy_, grid(std::uint64_t{count_} * static_cast<std::uint64_t>(ends_of_node(bodies().geometry()))),
        copy);
    const auto levels = box_levels(count_);
    for (std::uint32_t level = 1; level <= levels.size();) {
        const std::uint32_t both = level > 1 && level < levels.size() ? 2 : 1;
        const kernels::scene_bounds::BoundBoxes boxes{.bounds = leaf_bounds_,
                                                      .leaves = leaves_,
                                                      .count = count_,
                                                      .first_level = level,
                                                      .levels = both,
                                                      .boxes = boxes_,
                                                      .owners = box_owners_};
        const auto items = levels[level - 1] + (both == 2 ? levels[level] : 0);
        device_.launch(boxes_kernel_, grid(items), boxes);
        level += both;
    }
    const kernels::scene_bounds::BoundInnerNodes inner{.bounds = leaf_bounds_,
                                                       .leaves = leaves_,
                                                       .count = count_,
                                                       .boxes = boxes_,
                                                       .owners = box_owners_,
                                                       .inner = inner_,
                                                       .inner_bounds = inner_bounds_};
    device_.launch(inner_kernel_, grid(count_ - 1), inner);
}

void SceneTree::do_refit(const Frame& frame, bool all) {
    trees_.refit(frame, all);
    builds_next_ |= all;
    if (count_ == 0) return;
    const StageScope scope(device_, Stage::refit);
    build();
    bound();
}

} // namespace tandem
