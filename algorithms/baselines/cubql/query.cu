// SPDX-License-Identifier: MIT
// Kernels over cuBQL's trees; its traversal finds the leaves. Compiled to PTX when the project is built, and
// loaded like any kernel, so that clocks and traces include them.
#include "algorithms/kernels/status.clh"
#include "algorithms/baselines/cubql/build.h"
#include "backends/lanes.h"

#include <cuBQL/bvh.h>
#include <cuBQL/traversal/fixedBoxQuery.h>

#include <cstdint>

using Box = cuBQL::box3f;
using Node = cuBQL::bvh3f::Node;
using tandem::cubql_trees::TreeRow;

/// Adds 1 for each calling lane of a warp, with one atomic operation; returns the lane's previous value.
__device__ std::uint32_t next_row(std::uint32_t* counter) {
    const unsigned lanes = __activemask();
    const unsigned lane = threadIdx.x % 32;
    const unsigned before = __popc(lanes & ((1u << lane) - 1u));
    const int leader = __ffs(static_cast<int>(lanes)) - 1;
    std::uint32_t first = 0;
    if (before == 0) {
        first = atomicAdd(counter, static_cast<unsigned>(__popc(lanes)));
        if (first + __popc(lanes) < first) atomicAdd(counter + 1, 1u);
    }
    return __shfl_sync(lanes, first, leader) + before;
}

/// Bounds of tetrahedra from the tiles' lanes to consecutive boxes: box of slot i.
extern "C" __global__ void copy_boxes_cubql(const float* leaves, Box* boxes, std::uint32_t count) {
    const std::uint32_t step = gridDim.x * blockDim.x;
    for (std::uint32_t slot = blockIdx.x * blockDim.x + threadIdx.x; slot < count; slot += step) {
        const float* words = leaves + std::size_t{slot / TANDEM_LANES} * (6 * TANDEM_LANES) + slot % TANDEM_LANES;
        Box box;
        box.lower = {words[0], words[TANDEM_LANES], words[2 * TANDEM_LANES]};
        box.upper = {words[3 * TANDEM_LANES], words[4 * TANDEM_LANES], words[5 * TANDEM_LANES]};
        boxes[slot] = box;
    }
}

/// Bounds of all nodes, from the leaves up: the second child that is ready continues with the parent. `parents`:
/// by node of all bodies, the parent's index within its tree; ~0 for roots and nodes that are not used.
/// `ready`: a word per node, 0 before and after.
extern "C" __global__ void refit_cubql(Node* nodes, const std::uint32_t* parents, const std::uint32_t* node_bodies,
                                       const TreeRow* trees, const std::uint32_t* order, const Box* boxes,
                                       std::uint32_t* ready, std::uint32_t count) {
    const std::uint32_t step = gridDim.x * blockDim.x;
    for (std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x; i < count; i += step) {
        const TreeRow tree = trees[node_bodies[i]];
        const Node::Admin admin = nodes[i].admin;
        if (admin.count == 0 || i == tree.first_node + 1) continue;
        Box box;
        for (std::uint32_t j = 0; j < admin.count; ++j)
            box.extend(boxes[tree.first_box + order[tree.first_of_order + admin.offset + j]]);
        nodes[i].bounds = box;
        std::uint32_t up = parents[i];
        while (up != ~0u) {
            __threadfence();
            const std::uint32_t node = tree.first_node + up;
            if (atomicExch(ready + node, 1u) == 0u) break;
            __threadfence();
            ready[node] = 0;
            const Node* children = nodes + tree.first_node + nodes[node].admin.offset;
            // Written by other multiprocessors: volatile reads miss the first-level cache.
            const volatile float* words = reinterpret_cast<const volatile float*>(children);
            const volatile float* next = reinterpret_cast<const volatile float*>(children + 1);
            Box both;
            both.lower = {fminf(words[0], next[0]), fminf(words[1], next[1]), fminf(words[2], next[2])};
            both.upper = {fmaxf(words[3], next[3]), fmaxf(words[4], next[4]), fmaxf(words[5], next[5])};
            nodes[node].bounds = both;
            up = parents[node];
        }
    }
}

/// A query of each tetrahedron of the body with fewer ones against the other body's tree, for all body pairs. A
/// body pair is `parts` turns of a group. `windowed`: only pairs of the status' window of tetrahedra of body a.
extern "C" __global__ void collide_cubql(const Node* nodes, const TreeRow* trees, const std::uint32_t* order,
                                       const Box* boxes, const std::uint32_t* body_pairs, std::uint32_t pair_capacity,
                                       std::uint32_t parts, std::uint32_t windowed, std::uint32_t counting,
                                       uint2* found, std::uint32_t capacity, std::uint32_t* status) {
    const std::uint32_t body_pair_count = status[STATUS_BODY_PAIRS + 1] != 0
                                              ? pair_capacity
                                              : min(status[STATUS_BODY_PAIRS], pair_capacity);
    const std::uint32_t window_first = windowed ? status[STATUS_WINDOW_FIRST] : 0;
    const std::uint32_t window_end = windowed ? status[STATUS_WINDOW_END] : ~0u;
    std::uint64_t tests = 0;
    for (std::uint64_t turn = blockIdx.x; turn < std::uint64_t{body_pair_count} * parts; turn += gridDim.x) {
        const std::uint64_t pair = turn / parts;
        const TreeRow a = trees[body_pairs[2 * pair]];
        const TreeRow b = trees[body_pairs[2 * pair + 1]];
        const bool a_queries = a.count <= b.count;
        const TreeRow querying = a_queries ? a : b;
        const TreeRow queried = a_queries ? b : a;
        cuBQL::bvh3f tree;
        tree.nodes = const_cast<Node*>(nodes) + queried.first_node;
        tree.primIDs = const_cast<std::uint32_t*>(order) + queried.first_of_order;
        if (queried.count == 0) continue;
        const auto first = static_cast<std::uint32_t>(turn % parts) * blockDim.x + threadIdx.x;
        for (std::uint32_t item = first; item < querying.count; item += parts * blockDim.x) {
            const Box box = boxes[querying.first_box + item];
            if (box.lower.x > box.upper.x) continue; // skipped
            cuBQL::fixedBoxQuery::forEachPrim(
                [&](std::uint32_t other) {
                    ++tests;
                    const Box theirs = boxes[queried.first_box + other];
                    const std::uint32_t item_a = a_queries ? item : other;
                    if (theirs.lower.x <= theirs.upper.x && box.overlaps(theirs) && item_a >= window_first
                        && item_a < window_end) {
                        const std::uint32_t row = next_row(status + STATUS_PAIRS);
                        const std::uint32_t own = querying.first_box + item;
                        const std::uint32_t others = queried.first_box + other;
                        if (row < capacity) found[row] = a_queries ? uint2{own, others} : uint2{others, own};
                    }
                    return CUBQL_CONTINUE_TRAVERSAL;
                },
                tree, box);
        }
    }
    if (counting && tests != 0)
        atomicAdd(reinterpret_cast<unsigned long long*>(status + STATUS_OWN), static_cast<unsigned long long>(tests));
}
