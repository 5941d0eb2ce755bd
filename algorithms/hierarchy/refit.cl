// SPDX-License-Identifier: MIT
// Transform and refit, fused and level-synchronous. A launch processes strips: subtrees of at most `height` +
// 1 depths below a given root. A team of work-items builds the nodes of its strips bottom up in local memory.
// It writes them out once, neighbouring work-items to neighbouring words, so that each node reaches device
// memory once and in whole sectors. Leaves read vertices through the pose, so that rigid bodies store no
// transformed vertices. Inner nodes are the exact min/max of their children.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/bodies/leaf.clh"
#include "algorithms/hierarchy/node.clh"

// Capacity of a work-group in nodes: a power of two, at least one strip for each of its teams.
#ifndef TILE_NODES
#define TILE_NODES 128
#elif (defined(__CUDACC__) || defined(__OPENCL_C_VERSION__)) && TILE_NODES / TEAM_COUNT < 64 // see strips.h
#error "a team has no capacity for a strip of the greatest height, 5"
#endif

// Nodes move in units as wide as their alignment allows. Nodes of neighbouring work-items lie an odd number
// of units apart, so that they use different banks. Strips lie one unit further apart than needed.
#if K % 4 == 0 && PRECISION == 32
#define UNIT_REALS 4
typedef RealRow Unit;
#else
#define UNIT_REALS 2
typedef RealPair Unit;
#endif
#define NODE_UNITS (K / UNIT_REALS)
#define NODE_STRIDE (NODE_UNITS | 1)
#define HEAP(tile, strip, height) ((tile) + (strip) * (((2u << (height)) * NODE_STRIDE) + 1u))
#define TEAM_NODES (TILE_NODES / TEAM_COUNT)
#define MOST_STRIPS (TEAM_NODES / 16) // per team; a capacity for smaller strips would reduce this one
#define TEAM_TILE (TEAM_NODES * NODE_STRIDE + MOST_STRIPS)

// A job is a strip with all that its leaves need, so that one load starts them.
#define JOB_WORDS 8
#define JOB_BASE 0  // slot of heap index 0
#define JOB_ITEMS 1 // items of the chunk
#define JOB_ROOT 2  // heap index of the strip's root
#define JOB_BODY 3
#define JOB_FIRST 4      // the chunk's first item
#define JOB_TETRAHEDRA 5 // first of the body's tetrahedra
#define JOB_VERTICES 6   // first of the body's vertices
#define JOB_FLAGS 7      // as BODY_FLAGS

// Arguments of a launch.
typedef struct {
    GLOBAL real* nodes;
    GLOBAL const uint* trees;
    GLOBAL const uint* levels;
    Solids solids;
    GLOBAL const uint* jobs;
    uint level, height;
} Refit;

// Loads row `job` of the launch; past the last one, a row without items.
DEVICE void load_job(const Refit* refit, uint word, uint job, uint job_count, LOCAL uint* strip) {
    if (job < job_count)
        strip[word] = refit->jobs[(ulong)job * JOB_WORDS + word];
    else
        strip[word] = word == JOB_ROOT ? 1u : 0u;
}

// Negative zero becomes positive, so that equal slabs have equal bits.
DEVICE void bound_tetrahedron(const Refit* refit, LOCAL const uint* strip, uint item, real* node) {
    const BodyTetrahedron one = {strip[JOB_BODY], strip[JOB_TETRAHEDRA] + item, strip[JOB_VERTICES],
                                 strip[JOB_FLAGS]};
    for (int axis = 0; axis < DIRECTIONS; ++axis) {
        node[axis] = REAL_INFINITY;
        node[axis + DIRECTIONS] = -REAL_INFINITY;
    }
    widen_by_tetrahedron(&refit->solids, &one, node);
    for (int word = 0; word < K; ++word) node[word] = node[word] + (real)0;
}

// A word of the parent of two nodes.
#define MERGED(word, a, b) ((word) < DIRECTIONS ? MINIMUM(a, b) : MAXIMUM(a, b))

DEVICE Unit unit_of(const real* values) {
    Unit unit;
    unit.x = values[0];
    unit.y = values[1];
#if UNIT_REALS == 4
    unit.z = values[2];
    unit.w = values[3];
#endif
    return unit;
}

DEVICE Unit merged_unit(int word, Unit a, Unit b) {
    Unit unit;
    unit.x = MERGED(word, a.x, b.x);
    unit.y = MERGED(word + 1, a.y, b.y);
#if UNIT_REALS == 4
    unit.z = MERGED(word + 2, a.z, b.z);
    unit.w = MERGED(word + 3, a.w, b.w);
#endif
    return unit;
}

DEVICE void store_node(const real* values, LOCAL Unit* node) {
    UNROLL for (int i = 0; i < NODE_UNITS; ++i) node[i] = unit_of(values + i * UNIT_REALS);
}

DEVICE void merge_nodes(LOCAL const Unit* a, LOCAL const Unit* b, LOCAL Unit* node) {
    UNROLL for (int i = 0; i < NODE_UNITS; ++i) node[i] = merged_unit(i * UNIT_REALS, a[i], b[i]);
}

// A leaf of level 0 bounds a tetrahedron; a leaf of a higher level is the root of a chunk below.
DEVICE void make_leaf(const Refit* refit, LOCAL const uint* strip, uint node, real* values) {
    const uint item = strip[JOB_FIRST] + leaf_item(node, strip[JOB_ITEMS]);
    if (refit->level == 0u) {
        bound_tetrahedron(refit, strip, item, values);
        return;
    }
    GLOBAL const uint* tree = tree_of(refit->trees, strip[JOB_BODY]);
    GLOBAL const uint* level = level_of(refit->levels, tree, refit->level - 1u);
    GLOBAL const real* from = node_at(refit->nodes, chunk_at(tree[TREE_NODES], level, item).base + ROOT_NODE);
    for (int word = 0; word < K; ++word) values[word] = from[word];
}

// A node of the deepest depth: a leaf, or the parent of nodes from an earlier launch.
DEVICE void make_deepest(const Refit* refit, LOCAL const uint* strip, uint node, real* values) {
    if (is_leaf(node, strip[JOB_ITEMS])) {
        make_leaf(refit, strip, node, values);
        return;
    }
    GLOBAL const real* child = node_at(refit->nodes, strip[JOB_BASE] + first_child(node));
    for (int word = 0; word < K; ++word) values[word] = MERGED(word, child[word], child[word + K]);
}

// A work-item's node at one depth: its heap index in the chunk (`node`) and in the strip's own heap
// (`place`).
typedef struct {
    LOCAL const uint* strip;
    LOCAL Unit* heap;
    uint node, place;
} NodeAt;

DEVICE NodeAt strip_node(const Refit* refit, LOCAL const uint* strips, uint i, uint depth, LOCAL Unit* tile) {
    const uint in_depth = i & ((1u << depth) - 1u);
    NodeAt at;
    at.strip = strips + (i >> depth) * JOB_WORDS;
    at.heap = HEAP(tile, i >> depth, refit->height);
    at.node = (at.strip[JOB_ROOT] << depth) + in_depth;
    at.place = (1u << depth) + in_depth;
    return at;
}

// Small nodes are built in pairs. A work-item builds one larger node at a time, because a tile of two would
// leave local memory for too few work-groups.
#define IN_PAIRS (K <= 8)

// The two lowest depths, if there are two: a work-item builds two siblings and merges them in registers.
DEVICE void make_pairs(const Refit* refit, LOCAL const uint* strips, uint strip_count, LOCAL Unit* tile) {
    const uint depth = refit->height == 0u ? 0u : refit->height - 1u;
    const uint count = refit->height == 0u ? 0u : strip_count << depth;
    for (uint i = TEAM_LANE; i < count; i += TEAM_SIZE) {
        const NodeAt at = strip_node(refit, strips, i, depth, tile);
        if (at.node >= 2u * at.strip[JOB_ITEMS]) continue;
        const uint inner = is_leaf(at.node, at.strip[JOB_ITEMS]) ? 0u : 1u;
        real both[K];
        for (int axis = 0; axis < DIRECTIONS; ++axis) {
            both[axis] = REAL_INFINITY;
            both[axis + DIRECTIONS] = -REAL_INFINITY;
        }
        NO_UNROLL for (uint child = 0; child <= inner; ++child) {
            real values[K];
            make_deepest(refit, at.strip, (at.node << inner) + child, values);
            store_node(values, at.heap + ((at.place << inner) + child) * NODE_STRIDE);
            for (int word = 0; word < K; ++word) both[word] = MERGED(word, both[word], values[word]);
        }
        store_node(both, at.heap + at.place * NODE_STRIDE);
    }
}

// A depth above those, or the only one.
DEVICE void make_depth(const Refit* refit, LOCAL const uint* strips, uint strip_count, uint depth,
                       LOCAL Unit* tile) {
    for (uint i = TEAM_LANE; i < strip_count << depth; i += TEAM_SIZE) {
        const NodeAt at = strip_node(refit, strips, i, depth, tile);
        if (at.node >= 2u * at.strip[JOB_ITEMS]) continue;
        if (depth == refit->height || is_leaf(at.node, at.strip[JOB_ITEMS])) {
            real values[K];
            make_deepest(refit, at.strip, at.node, values);
            store_node(values, at.heap + at.place * NODE_STRIDE);
        } else {
            merge_nodes(at.heap + 2u * at.place * NODE_STRIDE, at.heap + (2u * at.place + 1u) * NODE_STRIDE,
                        at.heap + at.place * NODE_STRIDE);
        }
    }
}

// Copies `count` consecutive nodes, one unit per work-item. `part` is the position of the current unit in its
// node; it determines when to skip padding.
DEVICE void write_run(LOCAL const Unit* from, GLOBAL real* to, uint count) {
    uint part = TEAM_LANE % NODE_UNITS;
    from += TEAM_LANE / NODE_UNITS * NODE_STRIDE + part;
    for (uint i = TEAM_LANE; i < count * NODE_UNITS; i += TEAM_SIZE) {
        ((GLOBAL Unit*)to)[i] = *from;
        from += TEAM_SIZE / NODE_UNITS * NODE_STRIDE + TEAM_SIZE % NODE_UNITS;
        part += TEAM_SIZE % NODE_UNITS;
        if (NODE_STRIDE != NODE_UNITS && part >= (uint)NODE_UNITS) {
            part -= NODE_UNITS;
            from += NODE_STRIDE - NODE_UNITS;
        }
    }
}

// A whole chunk is one run of nodes; a part of a chunk is one run per depth.
DEVICE void write_strip(const Refit* refit, LOCAL const uint* strip, LOCAL const Unit* heap) {
    const uint end = 2u * strip[JOB_ITEMS];
    const uint root = strip[JOB_ROOT];
    for (uint depth = 0; depth <= refit->height; ++depth) {
        const uint first = root << depth;
        if (first >= end) return;
        const uint most = root == 1u ? (2u << refit->height) - 1u : 1u << depth;
        write_run(heap + (1u << depth) * NODE_STRIDE, refit->nodes + (ulong)(strip[JOB_BASE] + first) * K,
                  end - first < most ? end - first : most);
        if (root == 1u) return;
    }
}

// `first_job`, `job_count`: the strips of this launch. A team processes TEAM_NODES / 2^(height + 1) of them,
// at most MOST_STRIPS. `first_depth`: the depth at which the loop starts.
KERNEL void refit_strips(GLOBAL real* nodes, GLOBAL const uint* trees, GLOBAL const uint* levels,
                         GLOBAL const real* poses, GLOBAL const uint* tetrahedra, GLOBAL const real* vertices,
                         GLOBAL const real* next_poses, GLOBAL const real* next_vertices, float margin,
                         GLOBAL const uint* jobs, uint first_job, uint job_count, uint level, uint height,
                         uint first_depth) {
    LOCAL_ARRAY(Unit, tiles, TEAM_COUNT * TEAM_TILE);
    LOCAL_ARRAY(uint, rows, TEAM_COUNT * MOST_STRIPS * JOB_WORDS);
    const Refit refit = {nodes,
                         trees,
                         levels,
                         {tetrahedra, poses, vertices, next_poses, next_vertices, margin},
                         jobs + (ulong)first_job * JOB_WORDS,
                         level,
                         height};
    LOCAL Unit* tile = tiles + TEAM_ID * TEAM_TILE;
    LOCAL uint* strips = rows + TEAM_ID * (MOST_STRIPS * JOB_WORDS);
    const uint fitting = (uint)TEAM_NODES >> (height + 1u);
    const uint strip_count = fitting < MOST_STRIPS ? fitting : MOST_STRIPS;
    const uint first = (GROUP_ID * TEAM_COUNT + TEAM_ID) * strip_count;
    for (uint i = TEAM_LANE; i < strip_count * JOB_WORDS; i += TEAM_SIZE)
        load_job(&refit, i % JOB_WORDS, first + i / JOB_WORDS, job_count, strips + i / JOB_WORDS * JOB_WORDS);
    TEAM_BARRIER;
    if (IN_PAIRS) {
        make_pairs(&refit, strips, strip_count, tile);
        TEAM_BARRIER;
    }
    // PoCL 3.1 miscompiles barriers in a loop that might not run at all, and PoCL 5.0 aborts at a barrier
    // behind branches between which the turn decides. One depth is therefore always made, twice if it was in
    // pairs.
    for (uint up = 0; up <= first_depth; ++up) {
        make_depth(&refit, strips, strip_count, first_depth - up, tile);
        TEAM_BARRIER;
    }
    for (uint i = 0; i < strip_count; ++i) write_strip(&refit, strips + i * JOB_WORDS, HEAP(tile, i, height));
}

// Copies the leaves of a level above 0, one word per work-item.
DEVICE void copy_roots(GLOBAL real* nodes, uint first, GLOBAL const uint* level) {
    for (uint i = LOCAL_ID; i < level[LEVEL_ITEMS] * K; i += GROUP_SIZE) {
        const uint item = i / K;
        const Chunk chunk = chunk_at(first, level, item / CHUNK_ITEMS);
        const Chunk below = chunk_at(first, level - LEVEL_WORDS, item);
        const uint leaf = leaf_node(item % CHUNK_ITEMS, chunk.items);
        nodes[(ulong)(chunk.base + leaf) * K + i % K] = nodes[(ulong)(below.base + ROOT_NODE) * K + i % K];
    }
}

// Merges the inner nodes of one depth in all chunks of a level.
DEVICE void merge_depth(GLOBAL real* nodes, uint first, GLOBAL const uint* level, uint depth) {
    for (uint i = LOCAL_ID; i < (level[LEVEL_CHUNKS] << depth) * K; i += GROUP_SIZE) {
        const uint index = i / K;
        const uint word = i % K;
        const Chunk chunk = chunk_at(first, level, index >> depth);
        const uint node = first_below(ROOT_NODE, depth) + (index & ((1u << depth) - 1u));
        if (is_leaf(node, chunk.items)) continue;
        GLOBAL const real* child = nodes + (ulong)(chunk.base + first_child(node)) * K + word;
        const real a = child[0];
        const real b = child[K];
        nodes[(ulong)(chunk.base + node) * K + word] = word < DIRECTIONS ? MINIMUM(a, b) : MAXIMUM(a, b);
    }
}

// Refits the small levels from `first_level` on, and the volume of the whole body: the union of its top
// level's chunk roots (paper, Algorithm 1). One work-group per body.
KERNEL void refit_tops(GLOBAL real* nodes, GLOBAL real* volumes, GLOBAL const uint* trees,
                       GLOBAL const uint* levels, GLOBAL const uint* chosen, uint first_level) {
    const uint body = chosen[GROUP_ID];
    GLOBAL const uint* tree = tree_of(trees, body);
    const uint first = tree[TREE_NODES];
    const uint level_count = level_count_of(tree);
    GLOBAL const uint* rows = level_of(levels, tree, 0u);
    uint level = first_level;
    do { // runs at least once, with all its barriers: see refit_strips
        GLOBAL const uint* row = rows + (ulong)level * LEVEL_WORDS;
        const int exists = level < level_count;
        if (exists) copy_roots(nodes, first, row);
        BARRIER_GLOBAL;
        for (uint depth = LEAF_BITS; depth-- > 0u;) {
            if (exists) merge_depth(nodes, first, row, depth);
            BARRIER_GLOBAL;
        }
        ++level;
    } while (level < level_count);
    GLOBAL const uint* top = rows + (ulong)(level_count - 1u) * LEVEL_WORDS;
    for (uint word = LOCAL_ID; word < (uint)K; word += GROUP_SIZE) {
        real all = word < DIRECTIONS ? REAL_INFINITY : -REAL_INFINITY;
        for (uint chunk = 0; chunk < top[LEVEL_CHUNKS]; ++chunk) {
            const real own = node_at(nodes, chunk_at(first, top, chunk).base + ROOT_NODE)[word];
            all = word < DIRECTIONS ? MINIMUM(own, all) : MAXIMUM(own, all);
        }
        volumes[(ulong)body * K + word] = all;
    }
}

// Rows of three slots: a node and its two children. Both children are NO_CHILDREN for a skipped
// tetrahedron.
#define MASKED_WORDS 3
#define NO_CHILDREN 0xffffffffu

DEVICE real masked_word(GLOBAL const real* nodes, uint a, uint b, uint word) {
    if (a == NO_CHILDREN) return word < DIRECTIONS ? REAL_INFINITY : -REAL_INFINITY;
    return MERGED(word, node_at(nodes, a)[word], node_at(nodes, b)[word]);
}

// Runs between strips and tops in frames that skip tetrahedra. Their leaves get slabs that end before they
// start, which overlap nothing and widen nothing. The nodes above are rebuilt. One work-group per body
// processes its rows in `rounds`, some of them empty; each round reads only nodes of earlier ones.
// starts[body * rounds + round] is the first row of a round.
KERNEL void empty_nodes(GLOBAL real* nodes, GLOBAL const uint* rows, GLOBAL const uint* starts, uint rounds) {
    GLOBAL const uint* own = starts + (ulong)GROUP_ID * rounds;
    uint round = 0;
    do { // runs at least once: see refit_strips
        const ulong first = (ulong)own[round] * K;
        const ulong end = (ulong)own[round + 1u] * K;
        for (ulong i = first + LOCAL_ID; i < end; i += GROUP_SIZE) {
            GLOBAL const uint* row = rows + i / K * MASKED_WORDS;
            const uint word = (uint)(i % K);
            nodes[(ulong)row[0] * K + word] = masked_word(nodes, row[1], row[2], word);
        }
        BARRIER_GLOBAL;
        ++round;
    } while (round < rounds);
}
