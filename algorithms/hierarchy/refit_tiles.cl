// SPDX-License-Identifier: MIT
// Refit of tiles: a work-group makes up to 32 tiles of one level and the tile of the next that is over them,
// from vertices or from the roots of the level below. A tile's vertices come through the pose once, to local
// memory, and not once for each of the tetrahedra that share them.
#include "backends/portable.h"
#include "algorithms/hierarchy/tiles.clh"

// A work-group's job, a unit: tiles of one level that lie one after the other.
#define UNIT_WORDS 4
#define UNIT_FIRST 0
#define UNIT_COUNT 1
#define UNIT_PARENT 2 // the tile over them, or NO_TILE
#define UNIT_BODY 3   // whose volume the last root is, or NO_BODY
#define NO_TILE 0xffffffffu
#define NO_BODY 0xffffffffu

// Lanes' values of one word lie side by side, words LANES + 1 reals apart: those of one lane hit different
// banks as well.
#define ROW (LANES + 1)
#define ROOT_STRIDE (K | 1)

DEVICE real no_end(uint word) { return word < (uint)DIRECTIONS ? REAL_INFINITY : -REAL_INFINITY; }

DEVICE real merged(uint word, real a, real b) {
    return word < (uint)DIRECTIONS ? MINIMUM(b, a) : MAXIMUM(b, a);
}

// A tile's root from the bounds of its lanes, a word a work-item: a team's work. It is kept for the tile
// above.
DEVICE void make_root(LOCAL const real* bounds, LOCAL real* kept, GLOBAL real* root) {
    for (uint word = LANE_ID; word < (uint)K; word += (uint)LANE_STEP) {
        LOCAL const real* row = bounds + word * ROW;
        real all = no_end(word);
        UNROLL for (uint lane = 0; lane < (uint)LANES; ++lane) all = merged(word, all, row[lane]);
        kept[word] = all;
        root[word] = all;
    }
}

// What is above a unit's tiles, from the roots of these: the tile over them with its root, and the volume of
// the body if that is all of it. The whole group's work. `first_upper`: the first tile of level 1.
DEVICE void finish_unit(GLOBAL const uint* unit, LOCAL const real* kept, GLOBAL real* uppers,
                        uint first_upper, GLOBAL real* roots, GLOBAL real* volumes) {
    const uint count = unit[UNIT_COUNT];
    const uint parent = unit[UNIT_PARENT];
    const uint body = unit[UNIT_BODY];
    if (parent != NO_TILE) {
        GLOBAL real* boxes = uppers + (ulong)(parent - first_upper) * (K * LANES);
        for (uint i = LOCAL_ID; i < (uint)(K * LANES); i += (uint)GROUP_SIZE) {
            const uint word = i / LANES;
            const uint lane = i % LANES;
            boxes[i] = lane < count ? kept[lane * ROOT_STRIDE + word] : no_end(word);
        }
    }
    for (uint word = LOCAL_ID; word < (uint)K; word += (uint)GROUP_SIZE) {
        real all = no_end(word);
        for (uint tile = 0; tile < count; ++tile) all = merged(word, all, kept[tile * ROOT_STRIDE + word]);
        if (parent != NO_TILE) roots[(ulong)parent * K + word] = all;
        if (body != NO_BODY) volumes[(ulong)body * K + word] = all;
    }
}

// A lane's slabs, kept for the root of its tile. Negative zero becomes positive: equal slabs then have equal
// bits.
DEVICE void keep_slabs(const real* slabs, int empty, uint lane, LOCAL real* bounds) {
    UNROLL for (uint word = 0; word < (uint)K; ++word) {
        bounds[word * ROW + lane] = empty ? no_end(word) : slabs[word] + (real)0;
    }
}

// Level 0. `taking_part` has a word a tile, a bit for each tetrahedron that is there and not skipped.
KERNEL void refit_leaf_tiles(GLOBAL real* leaves, GLOBAL real* uppers, uint first_upper, GLOBAL real* roots,
                             GLOBAL real* volumes, GLOBAL const uint* units, GLOBAL const uint* tiles,
                             GLOBAL const uint* taking_part, GLOBAL const uint* starts,
                             GLOBAL const uint* vertex_numbers, GLOBAL const uint* corners,
                             GLOBAL const uint* bodies, GLOBAL const real* poses,
                             GLOBAL const real* vertices) {
    LOCAL_ARRAY(real, all_points, LANE_TEAMS * MOST_VERTICES * POINT_REALS);
    LOCAL_ARRAY(real, all_bounds, LANE_TEAMS * K * ROW);
    LOCAL_ARRAY(real, kept, LANES * ROOT_STRIDE);
    const Shapes shapes = {starts, vertex_numbers, corners, bodies, poses, vertices};
    LOCAL real* points = all_points + LANE_TEAM * (MOST_VERTICES * POINT_REALS);
    LOCAL real* bounds = all_bounds + LANE_TEAM * (K * ROW);
    GLOBAL const uint* unit = units + (ulong)GROUP_ID * UNIT_WORDS;
    const uint count = unit[UNIT_COUNT];
    uint i = LANE_TEAM;
    do { // once at least, as loops with barriers have to: a team without a tile goes through the first one
         // idly
        const int has_tile = i < count;
        const uint at = has_tile ? i : 0u;
        const uint number = unit[UNIT_FIRST] + at;
        const Tile tile = tile_at(tiles, number);
        load_vertices(&shapes, &tile, points);
        LANE_BARRIER;
        const uint there = taking_part[number];
        const Point drift = drift_at(poses, tile.body);
        FOR_LANES {
            real slabs[K];
            bound_corners(&shapes, &tile, points, lane, drift, slabs);
            keep_slabs(slabs, (there >> lane & 1u) == 0u, lane, bounds);
            if (!has_tile) continue;
            GLOBAL real* leaf = leaves + (ulong)number * (LEAF_WORDS * LANES) + lane;
            UNROLL for (uint axis = 0; axis < (uint)LEAF_DIRECTIONS; ++axis) {
                leaf[axis * LANES] = bounds[axis * ROW + lane];
                leaf[(LEAF_DIRECTIONS + axis) * LANES] = bounds[(DIRECTIONS + axis) * ROW + lane];
            }
        }
        LANE_BARRIER;
        if (has_tile) make_root(bounds, kept + at * ROOT_STRIDE, roots + (ulong)number * K);
        i += LANE_TEAMS;
    } while (i < count);
    BARRIER;
    finish_unit(unit, kept, uppers, first_upper, roots, volumes);
}

// A level above: its boxes are the roots of the tiles below.
KERNEL void refit_upper_tiles(GLOBAL real* uppers, uint first_upper, GLOBAL real* roots, GLOBAL real* volumes,
                              GLOBAL const uint* units, GLOBAL const uint* tiles) {
    LOCAL_ARRAY(real, all_bounds, LANE_TEAMS * K * ROW);
    LOCAL_ARRAY(real, kept, LANES * ROOT_STRIDE);
    LOCAL real* bounds = all_bounds + LANE_TEAM * (K * ROW);
    GLOBAL const uint* unit = units + (ulong)GROUP_ID * UNIT_WORDS;
    const uint count = unit[UNIT_COUNT];
    uint i = LANE_TEAM;
    do { // see refit_leaf_tiles
        const int has_tile = i < count;
        const uint at = has_tile ? i : 0u;
        const uint number = unit[UNIT_FIRST] + at;
        const Tile tile = tile_at(tiles, number);
        FOR_LANES {
            GLOBAL const real* below = root_of(roots, tile.boxes + lane);
            GLOBAL real* box = uppers + (ulong)(number - first_upper) * (K * LANES) + lane;
            UNROLL for (uint word = 0; word < (uint)K; ++word) {
                const real end = lane < tile.count ? below[word] : no_end(word);
                bounds[word * ROW + lane] = end;
                if (has_tile) box[word * LANES] = end;
            }
        }
        LANE_BARRIER;
        if (has_tile) make_root(bounds, kept + at * ROOT_STRIDE, roots + (ulong)number * K);
        LANE_BARRIER;
        i += LANE_TEAMS;
    } while (i < count);
    BARRIER;
    finish_unit(unit, kept, uppers, first_upper, roots, volumes);
}
