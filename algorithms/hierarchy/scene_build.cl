// SPDX-License-Identifier: MIT
// Builds the tree over a scene (scene_tree.clh) where the frame does so; otherwise the launches end at once.
// Leaves are ordered by 30-bit Morton codes of the centres of their bounds. Equal codes keep the order of
// bodies and of their builder, so that numbers of leaves continue the codes. Inner nodes are those of Karras
// ("Maximizing parallelism in the construction of BVHs, octrees, and k-d trees", 2012), ropes those of
// Prokopenko and Lebrun-Grandie ("Revising Apetrei's bounding volume hierarchy construction algorithm to
// allow stackless traversal", 2024). Each work-item makes whole nodes, independent of the others.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/hierarchy/scene_tree.clh"

#define AXES_OF_CODES 3u // the first directions of every k, which are linearly independent
#define CELLS 1024       // along each of them

// A region: lower ends along the axes of codes, then cells per length.
DEVICE RealRow region_of(const real* least, const real* most) {
    RealRow region;
    real extent = 0;
    for (uint axis = 0; axis < AXES_OF_CODES; ++axis) {
        const real width = most[axis] - least[axis];
        if (width > extent) extent = width;
    }
    region.x = least[0];
    region.y = least[1];
    region.z = least[2];
    region.w = extent > 0 ? CELLS / extent : (real)0;
    return region;
}

// Decides whether the frame builds the tree: where `request` is not 0, and every `period` frames. Then finds
// the region of all volumes. One work-group.
KERNEL void begin_build(GLOBAL const real* volumes, GLOBAL const uint* bodies, uint body_count, uint request,
                        uint period, GLOBAL uint* state, GLOBAL real* region) {
    LOCAL_ARRAY(real, ends, GROUP_SIZE * 2 * AXES_OF_CODES);
    const uint age = state[STATE_AGE] + 1u;
    const uint builds = request != 0u || age >= period ? 1u : 0u;
    for (uint axis = 0; axis < AXES_OF_CODES; ++axis) {
        real least = REAL_INFINITY;
        real most = -REAL_INFINITY;
        for (uint i = LOCAL_ID; i < (builds != 0u ? body_count : 0u); i += (uint)GROUP_SIZE) {
            GLOBAL const real* volume = volume_of(volumes, bodies[i]);
            least = MINIMUM(volume[axis], least);
            most = MAXIMUM(volume[axis + DIRECTIONS], most);
        }
        ends[LOCAL_ID * 2u * AXES_OF_CODES + axis] = least;
        ends[LOCAL_ID * 2u * AXES_OF_CODES + AXES_OF_CODES + axis] = most;
    }
    BARRIER_GLOBAL; // every work-item has read the state
    if (LOCAL_ID != 0u) return;
    state[STATE_BUILDS] = builds;
    state[STATE_AGE] = builds != 0u ? 0u : age;
    real least[AXES_OF_CODES];
    real most[AXES_OF_CODES];
    for (uint axis = 0; axis < AXES_OF_CODES; ++axis) {
        least[axis] = REAL_INFINITY;
        most[axis] = -REAL_INFINITY;
        for (uint i = 0; i < (uint)GROUP_SIZE; ++i) {
            LOCAL const real* own = ends + i * 2u * AXES_OF_CODES;
            least[axis] = MINIMUM(own[axis], least[axis]);
            most[axis] = MAXIMUM(own[axis + AXES_OF_CODES], most[axis]);
        }
    }
    if (builds != 0u) ((GLOBAL RealRow*)region)[0] = region_of(least, most);
}

DEVICE uint builds_of(GLOBAL const uint* state, uint count) { return state[STATE_BUILDS] != 0u ? count : 0u; }

// The cell of the middle of a slab. Slabs without a middle, such as those of a skipped tetrahedron, are in
// the first cell.
DEVICE uint cell_of(real lower, real upper, real least, real scale) {
    const real cell = ((real)0.5 * lower + (real)0.5 * upper - least) * scale;
    return cell > 0 ? (cell < CELLS - 1 ? (uint)cell : CELLS - 1u) : 0u;
}

// Moves bit i of a 10-bit number to bit 3i.
DEVICE uint spread(uint bits) {
    bits = (bits | bits << 16) & 0x030000ffu;
    bits = (bits | bits << 8) & 0x0300f00fu;
    bits = (bits | bits << 4) & 0x030c30c3u;
    return (bits | bits << 2) & 0x09249249u;
}

// Keys and values of the sort: the Morton code of each tetrahedron and its row number. `rows`: its slot in
// `nodes`, the trees of bodies, then owner and item, in the order of bodies.
KERNEL void code_leaves(GLOBAL const uint* rows, uint count, GLOBAL const real* nodes,
                        GLOBAL const real* region, GLOBAL const uint* state, GLOBAL uint* keys,
                        GLOBAL uint* values) {
    const uint leaves = builds_of(state, count);
    const RealRow cells = ((GLOBAL const RealRow*)region)[0];
    for (uint i = GLOBAL_ID; i < leaves; i += GLOBAL_COUNT) {
        GLOBAL const real* slabs = node_at(nodes, ((GLOBAL const WordRow*)rows)[i].x);
        const uint x = cell_of(slabs[0], slabs[DIRECTIONS], cells.x, cells.w);
        const uint y = cell_of(slabs[1], slabs[DIRECTIONS + 1], cells.y, cells.w);
        const uint z = cell_of(slabs[2], slabs[DIRECTIONS + 2], cells.z, cells.w);
        keys[i] = spread(x) << 2 | spread(y) << 1 | spread(z);
        values[i] = i;
    }
}

// Length of the common prefix of the keys of leaves i and j, which their numbers continue; -1 without leaf j.
DEVICE int common_bits(GLOBAL const uint* keys, uint count, uint i, uint j) {
    if (j >= count) return -1; // also one before the first
    const uint different = keys[i] ^ keys[j];
    return different != 0u ? (int)COUNT_LEADING_ZEROS(different) : 32 + (int)COUNT_LEADING_ZEROS(i ^ j);
}

// The rope of a node whose last leaf is `last`: the largest node that starts at the next leaf and ends before
// the end of the node that covers both.
DEVICE uint rope_after(GLOBAL const uint* keys, uint count, uint last) {
    const uint next = last + 1u;
    if (next == count) return NO_NODE;
    const int is_inner = common_bits(keys, count, next, next + 1u) > common_bits(keys, count, next, last);
    return is_inner ? next : next | SCENE_LEAF;
}

// The other end of inner node i: the last leaf, in the direction in which the prefix is longer, that shares
// more bits with leaf i than the neighbour on the other side. `step`: 1 or -1, modulo 2^32.
DEVICE uint other_end(GLOBAL const uint* keys, uint count, uint i, uint step) {
    const int least = common_bits(keys, count, i, i - step);
    uint most = 2;
    // Leaves number fewer than 2^31, so that a place before the first or behind the last one is no leaf.
    while (common_bits(keys, count, i, i + most * step) > least) most *= 2u;
    uint length = 0;
    for (uint part = most / 2u; part > 0u; part /= 2u)
        if (common_bits(keys, count, i, i + (length + part) * step) > least) length += part;
    return i + length * step;
}

// The last leaf of the left child of an inner node over leaves first..last.
DEVICE uint split_of(GLOBAL const uint* keys, uint count, uint first, uint last) {
    const int common = common_bits(keys, count, first, last);
    uint low = first; // shares more bits with the first leaf than the last one does
    uint high = last;
    while (high - low > 1u) {
        const uint middle = low + (high - low) / 2u;
        if (common_bits(keys, count, first, middle) > common)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Makes inner nodes and leaves from the sorted keys and row numbers.
KERNEL void link_nodes(GLOBAL const uint* keys, GLOBAL const uint* values, GLOBAL const uint* rows,
                       uint count, GLOBAL const uint* state, GLOBAL uint* leaves, GLOBAL uint* inner) {
    const uint built = builds_of(state, count);
    for (uint i = GLOBAL_ID; i < built; i += GLOBAL_COUNT) {
        const WordRow row = ((GLOBAL const WordRow*)rows)[values[i]];
        const WordRow leaf = {row.x, rope_after(keys, count, i), row.y, row.z};
        ((GLOBAL WordRow*)leaves)[i] = leaf;
        if (i + 1u == count) continue;
        const int is_first = common_bits(keys, count, i, i + 1u) > common_bits(keys, count, i, i - 1u);
        const uint end = other_end(keys, count, i, is_first ? 1u : 0xffffffffu);
        const uint first = is_first ? i : end;
        const uint last = is_first ? end : i;
        const uint split = split_of(keys, count, first, last);
        const WordRow node = {split == first ? split | SCENE_LEAF : split, rope_after(keys, count, last),
                              MANY_BODIES, end};
        ((GLOBAL WordRow*)inner)[i] = node;
    }
}
