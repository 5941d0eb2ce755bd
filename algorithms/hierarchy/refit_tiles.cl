// SPDX-License-Identifier: MIT
// Refit of tiles. A work-group builds up to 32 tiles of one level and their parent tile, from vertices or
// from the roots of the level below. Each vertex of a tile is transformed once, into local memory, not once
// per tetrahedron that shares it.
// Host variants: AXES K PRECISION PRESSURE_SLAB SLABS=0|1, in lanes; of higher levels: PRECISION=32 SLABS=1
// or K=18 SLABS=1 or PRESSURE_SLAB=1 SLABS=1 Host constants: MARGIN MOTION PLACEMENT ROUNDING
#include "backends/portable.h"
#include "algorithms/hierarchy/tiles.clh"

// A unit is the job of a work-group: consecutive tiles of one level.
#define UNIT_WORDS 4
#define UNIT_FIRST 0
#define UNIT_COUNT 1
#define UNIT_PARENT 2 // their parent tile, or NO_TILE
#define UNIT_BODY 3   // body whose volume is the last root, or NO_BODY
#define NO_BODY 0xffffffffu

// Tiles whose marks a team of bound_touched_tiles reads at once.
#define TILES_A_TURN 8u

// The lanes' values of one word are adjacent, and read four at a time. Words lie LANES + 4 reals apart, so
// that such reads of adjacent words use different banks.
#define ROW (LANES + 4)
#define ROOT_STRIDE (K | 1)

DEVICE real no_end(uint word) { return word < (uint)DIRECTIONS ? REAL_INFINITY : -REAL_INFINITY; }

DEVICE real merged(uint word, real a, real b) {
    return word < (uint)DIRECTIONS ? MINIMUM(b, a) : MAXIMUM(b, a);
}

// Frames that the bounds contain: the frame and its successor with MOTION_LINEAR.
#define FRAMES (MOTION == MOTION_LINEAR ? 2u : 1u)

// Stores a lane's slabs for the root of its tile. Upper ends are negated, so that roots are minima. `added`:
// merges them with those of the frame before.
DEVICE void keep_slabs(const real* slabs, uint lane, int added, LOCAL real* bounds) {
    UNROLL for (uint word = 0; word < (uint)K; ++word) {
        const real end = word < (uint)DIRECTIONS ? slabs[word] : -slabs[word];
        LOCAL real* kept = bounds + word * ROW + lane;
        *kept = added ? MINIMUM(end, *kept) : end;
    }
}

// Reduces the stored slabs of a tile to its root, one word per work-item of a team, and stores it in `kept`
// for the parent tile. Negative zero becomes positive as in leaves, so that equal slabs have equal bits.
DEVICE void make_root(LOCAL const real* bounds, LOCAL real* kept, GLOBAL real* root) {
    for (uint word = LANE_ID; word < (uint)K; word += (uint)LANE_STEP) {
        LOCAL const RealRow* row = (LOCAL const RealRow*)(bounds + word * ROW);
        RealRow four = row[0];
        UNROLL for (uint i = 1; i < (uint)LANES / 4u; ++i) {
            four.x = MINIMUM(row[i].x, four.x);
            four.y = MINIMUM(row[i].y, four.y);
            four.z = MINIMUM(row[i].z, four.z);
            four.w = MINIMUM(row[i].w, four.w);
        }
        const real first = MINIMUM(four.x, four.y);
        const real last = MINIMUM(four.z, four.w);
        const real least = MINIMUM(first, last);
        const real all = (word < (uint)DIRECTIONS ? least : -least) + (real)0;
        kept[word] = all;
        root[word] = all;
    }
}

// Builds the levels above a unit's tiles from their roots: the parent tile with its root, and the volume of
// the body if the unit covers it. The whole group calls it. `first_upper`: the first tile of level 1.
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

// Stores the slabs of all vertices of the tile, each once, distributed over the lanes. Their union is that of
// the tetrahedra if all of these are active.
DEVICE void keep_vertices(const Shapes* shapes, const Tile* tile, LOCAL const real* points, int added,
                          LOCAL real* bounds) {
    const Point drift = drift_at(shapes->poses, tile->body);
    const uint count = vertices_of(shapes, tile);
    FOR_LANES {
        real slabs[K];
        begin_slabs(slabs);
        for (uint i = lane; i < count; i += (uint)LANES)
            widen_by_vertex(shapes, tile, points, i, drift, slabs);
        keep_slabs(slabs, lane, added, bounds);
    }
}

// Slabs of a tetrahedron, of which `active` has a bit; of one that is not active they contain nothing.
DEVICE void active_slabs(const Shapes* shapes, const Tile* tile, LOCAL const real* points, uint active,
                         uint lane, real* slabs) {
    bound_corners(shapes, tile, points, lane, drift_at(shapes->poses, tile->body), slabs);
    const int empty = (active >> lane & 1u) == 0u;
    UNROLL for (uint word = 0; word < (uint)K; ++word) slabs[word] = empty ? no_end(word) : slabs[word];
}

// `added`: merges the slabs with those of the frame before.
DEVICE void write_leaf(const real* slabs, uint lane, int added, GLOBAL real* leaves) {
    UNROLL for (uint axis = 0; axis < (uint)LEAF_DIRECTIONS; ++axis) {
        const real lower = slabs[axis] + (real)0;
        const real upper = slabs[DIRECTIONS + axis] + (real)0;
        GLOBAL real* low = leaves + axis * LANES + lane;
        GLOBAL real* high = leaves + (LEAF_DIRECTIONS + axis) * LANES + lane;
        *low = added ? MINIMUM(lower, *low) : lower;
        *high = added ? MAXIMUM(upper, *high) : upper;
    }
}

// Level 0. `taking_part`: one word per tile, with a bit for each tetrahedron that exists and is not skipped.
// `stored`: whether to store the leaves, too; otherwise bound_touched_tiles does, except those of bodies of
// one tile, which the walk does not mark.
KERNEL void refit_leaf_tiles(GLOBAL real* leaves, GLOBAL real* uppers, uint first_upper, GLOBAL real* roots,
                             GLOBAL real* volumes, GLOBAL const uint* units, GLOBAL const uint* tiles,
                             GLOBAL const uint* taking_part, GLOBAL const uint* starts,
                             GLOBAL const uint* vertex_numbers, GLOBAL const uint* corners,
                             GLOBAL const uint* bodies, GLOBAL const real* poses, GLOBAL const real* vertices,
                             GLOBAL const real* next_poses, GLOBAL const real* next_vertices, float margin,
                             uint stored) {
    LOCAL_ARRAY(real, all_points, LANE_TEAMS * MOST_VERTICES * POINT_REALS);
    LOCAL_ARRAY(RealRow, all_bounds, LANE_TEAMS * K * ROW / 4);
    LOCAL_ARRAY(real, kept, LANES * ROOT_STRIDE);
    LOCAL real* points = all_points + LANE_TEAM * (MOST_VERTICES * POINT_REALS);
    LOCAL real* bounds = (LOCAL real*)all_bounds + LANE_TEAM * (K * ROW);
    GLOBAL const uint* unit = units + (ulong)GROUP_ID * UNIT_WORDS;
    const uint count = unit[UNIT_COUNT];
    uint i = LANE_TEAM;
    // Runs at least once, as loops with barriers must. A team without a tile processes the first one without
    // writing.
    do {
        const int has_tile = i < count;
        const uint at = has_tile ? i : 0u;
        const uint number = unit[UNIT_FIRST] + at;
        const Tile tile = tile_at(tiles, number);
        const uint active = taking_part[number];
        uint frame = 0;
        do {
            const int added = frame > 0u;
            const Shapes shapes = {starts,
                                   vertex_numbers,
                                   corners,
                                   bodies,
                                   added ? next_poses : poses,
                                   added ? next_vertices : vertices,
                                   margin};
            load_vertices(&shapes, &tile, points);
            LANE_BARRIER;
            const int stores = stored != 0u || unit[UNIT_PARENT] == NO_TILE;
            if (!stores && active == 0xffffffffu >> (LANES - tile.count)) {
                keep_vertices(&shapes, &tile, points, added, bounds);
            } else {
                GLOBAL real* own = leaves + (ulong)number * (LEAF_WORDS * LANES);
                FOR_LANES {
                    real slabs[K];
                    active_slabs(&shapes, &tile, points, active, lane, slabs);
                    if (stores && has_tile) write_leaf(slabs, lane, added, own);
                    keep_slabs(slabs, lane, added, bounds);
                }
            }
            LANE_BARRIER;
            ++frame;
        } while (frame < FRAMES);
        if (has_tile) make_root(bounds, kept + at * ROOT_STRIDE, roots + (ulong)number * K);
        i += LANE_TEAMS;
    } while (i < count);
    BARRIER;
    finish_unit(unit, kept, uppers, first_upper, roots, volumes);
}

// Leaves of the tiles that the upper levels of the walk have marked. It clears the marks, one word per tile
// and a multiple of TILES_A_TURN of them.
KERNEL void bound_touched_tiles(GLOBAL real* leaves, GLOBAL uint* marks, uint tile_count,
                                GLOBAL const uint* tiles, GLOBAL const uint* taking_part,
                                GLOBAL const uint* starts, GLOBAL const uint* vertex_numbers,
                                GLOBAL const uint* corners, GLOBAL const uint* bodies,
                                GLOBAL const real* poses, GLOBAL const real* vertices,
                                GLOBAL const real* next_poses, GLOBAL const real* next_vertices,
                                float margin) {
    LOCAL_ARRAY(real, all_points, LANE_TEAMS * MOST_VERTICES * POINT_REALS);
    LOCAL real* points = all_points + LANE_TEAM * (MOST_VERTICES * POINT_REALS);
    const uint step = GROUP_COUNT * LANE_TEAMS * TILES_A_TURN;
    uint first = (GROUP_ID * LANE_TEAMS + LANE_TEAM) * TILES_A_TURN;
    do { // runs at least once: see refit_leaf_tiles
        const uint start = first < tile_count ? first : 0u;
        uint touched = 0;
        UNROLL for (uint i = 0; i < TILES_A_TURN; i += 4u) {
            const WordRow four = ((GLOBAL const WordRow*)marks)[(start + i) / 4u];
            touched |= (four.x | four.y << 1 | four.z << 2 | four.w << 3) << i;
        }
        touched = first < tile_count ? touched : 0u;
        LANE_BARRIER; // all have read the marks
        for (uint i = LANE_ID; touched != 0u && i < TILES_A_TURN; i += (uint)LANE_STEP) marks[start + i] = 0u;
        first += step;
        if (TEAM_IS_FREE && touched == 0u) continue;
        do { // at least once
            const int has_tile = touched != 0u;
            const uint at = has_tile ? highest_bit(touched) : 0u;
            const uint number = start + at;
            const Tile tile = tile_at(tiles, number);
            uint frame = 0;
            do {
                const int added = frame > 0u;
                const Shapes shapes = {starts,
                                       vertex_numbers,
                                       corners,
                                       bodies,
                                       added ? next_poses : poses,
                                       added ? next_vertices : vertices,
                                       margin};
                load_vertices(&shapes, &tile, points);
                LANE_BARRIER;
                GLOBAL real* own = leaves + (ulong)number * (LEAF_WORDS * LANES);
                FOR_LANES {
                    real slabs[K];
                    active_slabs(&shapes, &tile, points, taking_part[number], lane, slabs);
                    if (has_tile) write_leaf(slabs, lane, added, own);
                }
                LANE_BARRIER;
                ++frame;
            } while (frame < FRAMES);
            touched &= ~(1u << at);
        } while (touched != 0u);
    } while (first < tile_count);
}

// A higher level, whose boxes are the roots of the tiles below.
KERNEL void refit_upper_tiles(GLOBAL real* uppers, uint first_upper, GLOBAL real* roots, GLOBAL real* volumes,
                              GLOBAL const uint* units, GLOBAL const uint* tiles) {
    LOCAL_ARRAY(RealRow, all_bounds, LANE_TEAMS * K * ROW / 4);
    LOCAL_ARRAY(real, kept, LANES * ROOT_STRIDE);
    LOCAL real* bounds = (LOCAL real*)all_bounds + LANE_TEAM * (K * ROW);
    GLOBAL const uint* unit = units + (ulong)GROUP_ID * UNIT_WORDS;
    const uint count = unit[UNIT_COUNT];
    uint i = LANE_TEAM;
    do { // runs at least once: see refit_leaf_tiles
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
            keep_slabs(slabs, lane, 0, bounds);
        }
        LANE_BARRIER;
        if (has_tile) make_root(bounds, kept + at * ROOT_STRIDE, roots + (ulong)number * K);
        LANE_BARRIER;
        i += LANE_TEAMS;
    } while (i < count);
    BARRIER;
    finish_unit(unit, kept, uppers, first_upper, roots, volumes);
}
