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
#define NO_BODY 0xffffffffu

// Lanes' values of one word lie side by side, words LANES + 1 reals apart: those of one lane hit different
// banks as well.
#define ROW (LANES + 1)
#define ROOT_STRIDE (K | 1)

DEVICE real no_end(uint word) { return word < (uint)DIRECTIONS ? REAL_INFINITY : -REAL_INFINITY; }

DEVICE real merged(uint word, real a, real b) {
    return word < (uint)DIRECTIONS ? MINIMUM(b, a) : MAXIMUM(b, a);
}

// Slabs of a lane for the root of its tile: upper ends negated, so that roots are least values.
DEVICE void keep_slabs(const real* slabs, uint lane, LOCAL real* bounds) {
    UNROLL for (uint word = 0; word < (uint)K; ++word) {
        bounds[word * ROW + lane] = word < (uint)DIRECTIONS ? slabs[word] : -slabs[word];
    }
}

// A tile's root from what its lanes kept, a word a work-item: a team's work. It is kept for the tile above.
// Negative zero becomes positive, here as in leaves: equal slabs then have equal bits.
DEVICE void make_root(LOCAL const real* bounds, LOCAL real* kept, GLOBAL real* root) {
    for (uint word = LANE_ID; word < (uint)K; word += (uint)LANE_STEP) {
        LOCAL const real* row = bounds + word * ROW;
        real least = REAL_INFINITY;
        UNROLL for (uint lane = 0; lane < (uint)LANES; ++lane) least = MINIMUM(row[lane], least);
        const real all = (word < (uint)DIRECTIONS ? least : -least) + (real)0;
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

DEVICE void begin_slabs(real* slabs) {
    UNROLL for (uint word = 0; word < (uint)K; ++word) slabs[word] = no_end(word);
}

// Slabs of all vertices of the tile, each once, a lane those that are its: their union is that of the
// tetrahedra, as long as every one of these takes part.
DEVICE void keep_vertices(const Shapes* shapes, const Tile* tile, LOCAL const real* points, Point drift,
                          LOCAL real* bounds) {
    const uint count = vertices_of(shapes, tile);
    FOR_LANES {
        real slabs[K];
        begin_slabs(slabs);
        for (uint i = lane; i < count; i += (uint)LANES)
            widen_by_point(point_at(points, i), drift, slabs, slabs + DIRECTIONS);
        keep_slabs(slabs, lane, bounds);
    }
}

// The same from the tetrahedra that take part, a bit each.
DEVICE void keep_tetrahedra(const Shapes* shapes, const Tile* tile, LOCAL const real* points, Point drift,
                            uint there, LOCAL real* bounds) {
    FOR_LANES {
        real slabs[K];
        begin_slabs(slabs);
        if ((there >> lane & 1u) != 0u) bound_corners(shapes, tile, points, lane, drift, slabs);
        keep_slabs(slabs, lane, bounds);
    }
}

DEVICE void write_leaves(const Shapes* shapes, const Tile* tile, LOCAL const real* points, Point drift,
                         uint there, GLOBAL real* leaves) {
    FOR_LANES {
        real slabs[K];
        bound_corners(shapes, tile, points, lane, drift, slabs);
        const int empty = (there >> lane & 1u) == 0u;
        UNROLL for (uint axis = 0; axis < (uint)LEAF_DIRECTIONS; ++axis) {
            const real lower = slabs[axis] + (real)0;
            const real upper = slabs[DIRECTIONS + axis] + (real)0;
            leaves[axis * LANES + lane] = empty ? REAL_INFINITY : lower;
            leaves[(LEAF_DIRECTIONS + axis) * LANES + lane] = empty ? -REAL_INFINITY : upper;
        }
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
    // Once at least, as loops with barriers have to: a team without a tile goes through the first one idly.
    do {
        const int has_tile = i < count;
        const uint at = has_tile ? i : 0u;
        const uint number = unit[UNIT_FIRST] + at;
        const Tile tile = tile_at(tiles, number);
        load_vertices(&shapes, &tile, points);
        LANE_BARRIER;
        const uint there = taking_part[number];
        const Point drift = drift_at(poses, tile.body);
        if (there == 0xffffffffu >> (LANES - tile.count))
            keep_vertices(&shapes, &tile, points, drift, bounds);
        else
            keep_tetrahedra(&shapes, &tile, points, drift, there, bounds);
        if (has_tile)
            write_leaves(&shapes, &tile, points, drift, there, leaves + (ulong)number * (LEAF_WORDS * LANES));
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
            real slabs[K];
            UNROLL for (uint word = 0; word < (uint)K; ++word) {
                slabs[word] = lane < tile.count ? below[word] : no_end(word);
                if (has_tile) box[word * LANES] = slabs[word];
            }
            keep_slabs(slabs, lane, bounds);
        }
        LANE_BARRIER;
        if (has_tile) make_root(bounds, kept + at * ROOT_STRIDE, roots + (ulong)number * K);
        LANE_BARRIER;
        i += LANE_TEAMS;
    } while (i < count);
    BARRIER;
    finish_unit(unit, kept, uppers, first_upper, roots, volumes);
}
