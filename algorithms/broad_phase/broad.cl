// SPDX-License-Identifier: MIT
// Finds body pairs from the volumes of the last refit: all pairs of bodies with overlapping root k-DOPs,
// except pairs of two fixed bodies. With SELF also pairs of a moving body with itself. Bodies are in a
// spatial order, fixed ones last, in tiles of BROAD_TILE. Two tiles are skipped if their unions do not
// overlap; otherwise all their pairs are tested.
// Host variants: AXES K PRECISION PRESSURE_SLAB
#include "backends/portable.h"
#include "algorithms/broad_phase/filters.clh"
#include "algorithms/broad_phase/tile.clh"
#include "algorithms/kernels/status.clh"
#include "algorithms/kernels/rows.clh"
#include "algorithms/bounds/volume.clh"

#ifndef SELF
#define SELF 0
#endif

// 1: the pairs of tiles that have bodies of one world are listed; 0: all are numbered.
#ifndef WORLDS
#define WORLDS 0
#endif

// In roots and unions a volume is DIRECTIONS rows {lower, upper}.

DEVICE RealPair slab_of(GLOBAL const real* volumes, GLOBAL const uint* order, uint position, uint axis) {
    GLOBAL const real* root = volume_of(volumes, order[position]);
    RealPair slab;
    slab.x = root[axis];
    slab.y = root[axis + DIRECTIONS];
    return slab;
}

// A work-group copies the root volumes of one tile in the order of bodies, and computes their union.
KERNEL void bound_tiles(GLOBAL const real* volumes, GLOBAL const uint* order, uint body_count,
                        GLOBAL RealPair* roots, GLOBAL RealPair* unions) {
    LOCAL_ARRAY(RealPair, tile, BROAD_TILE * DIRECTIONS);
    const uint first = GROUP_ID * BROAD_TILE;
    const uint count = body_count - first < BROAD_TILE ? body_count - first : BROAD_TILE;
    for (uint i = LOCAL_ID; i < count * DIRECTIONS; i += GROUP_SIZE) {
        const RealPair slab = slab_of(volumes, order, first + i / DIRECTIONS, i % DIRECTIONS);
        tile[i] = slab;
        roots[(ulong)first * DIRECTIONS + i] = slab;
    }
    BARRIER;
    for (uint axis = LOCAL_ID; axis < DIRECTIONS; axis += GROUP_SIZE) {
        RealPair all = tile[axis];
        for (uint i = 1; i < count; ++i) {
            const RealPair own = tile[i * DIRECTIONS + axis];
            all.x = MINIMUM(own.x, all.x);
            all.y = MAXIMUM(own.y, all.y);
        }
        unions[(ulong)GROUP_ID * DIRECTIONS + axis] = all;
    }
}

typedef struct {
    uint row, column;
} TilePair;

// Pair of tiles number `index`. `list`: rows of two words, with WORLDS.
DEVICE TilePair tile_pair_of(GLOBAL const uint* list, uint tiles, uint index) {
    TilePair pair;
    pair.row = WORLDS ? list[2u * index] : index / tiles;
    pair.column = WORLDS ? list[2u * index + 1u] : index % tiles;
    return pair;
}

// Number of pairs of tiles.
DEVICE uint tile_pairs_in(uint tiles, uint moving_count, uint listed) {
    return WORLDS ? listed : (moving_count + BROAD_TILE - 1u) / BROAD_TILE * tiles;
}

// Whether the pairs of these tiles must be tested. Each pair of tiles is tested once, with row <= column.
DEVICE int tiles_overlap(GLOBAL const RealPair* unions, TilePair pair) {
    const uint row = pair.row;
    const uint column = pair.column;
    GLOBAL const RealPair* a = unions + (ulong)row * DIRECTIONS;
    GLOBAL const RealPair* b = unions + (ulong)column * DIRECTIONS;
    if (column < row) return 0;
    for (int axis = 0; axis < DIRECTIONS; ++axis)
        if (starts_beyond(a[axis].x, b[axis].y) || starts_beyond(b[axis].x, a[axis].y)) return 0;
    return 1;
}

// Closed overlap: touching overlaps. Most bodies are disjoint along the first axes, so that whole groups
// return early.
DEVICE int volumes_overlap(const RealPair* a, LOCAL const RealPair* b) {
    int apart = 0;
    UNROLL for (int axis = 0; axis < DIRECTIONS; ++axis) {
        const RealPair slab = b[axis];
        apart |= starts_beyond(a[axis].x, slab.y);
        apart |= starts_beyond(slab.x, a[axis].y);
        if (axis % 3 == 2 && apart) return 0;
    }
    return !apart;
}

// Bit c is set if the body at `position` overlaps column c and precedes it in the order.
DEVICE uint overlapping_columns(GLOBAL const RealPair* roots, int is_only_tile, uint position,
                                LOCAL const RealPair* columns, uint first, uint count) {
    RealPair own[DIRECTIONS];
    uint hits = 0;
    UNROLL for (int axis = 0; axis < DIRECTIONS; ++axis) own[axis] =
        is_only_tile ? columns[position * DIRECTIONS + axis] : roots[(ulong)position * DIRECTIONS + axis];
    NO_UNROLL for (uint column = 0; column < count; ++column) {
        if (volumes_overlap(own, columns + column * DIRECTIONS)) hits |= 1u << column;
    }
    return position < first ? hits : hits & 0xfffffffeu << (position - first);
}

// Bit c is set if column c is the body at `position` itself, and it is one that SELF pairs with itself. A
// body of which nothing takes part has an empty volume and no pair.
DEVICE uint own_column(GLOBAL const real* volumes, GLOBAL const uint* bodies, uint body, uint position,
                       uint first) {
    if (SELF == SELF_OFF || position < first || position - first >= BROAD_TILE) return 0u;
    GLOBAL const real* volume = volume_of(volumes, body);
    if (starts_beyond(volume[0], volume[DIRECTIONS])) return 0u;
    const int deformable = (bodies[(ulong)body * BODY_WORDS + BODY_FLAGS] & BODY_IN_WORLD) != 0u;
    return SELF == SELF_ON || deformable ? 1u << (position - first) : 0u;
}

// Those of the columns `hits` whose bodies may meet body `a`.
DEVICE uint filtered(GLOBAL const uint* filters, uint a, GLOBAL const uint* columns, uint hits) {
    uint kept = 0;
    for (; hits != 0u; hits &= hits - 1u) {
        const uint column = 31u - COUNT_LEADING_ZEROS(hits & (~hits + 1u));
        if (may_meet(filters, a, columns[column])) kept |= 1u << column;
    }
    return kept;
}

// Writes the pairs of body `a` with the bodies of those columns that `hits` marks, from number `index` on, up
// to the capacity.
DEVICE void write_pairs(GLOBAL uint* pairs, uint capacity, uint index, uint a, GLOBAL const uint* columns,
                        uint hits) {
    for (; hits != 0u; hits &= hits - 1u, ++index) {
        const uint b = columns[31u - COUNT_LEADING_ZEROS(hits & (~hits + 1u))];
        if (index >= capacity) return;
        pairs[2u * (ulong)index] = a < b ? a : b;
        pairs[2u * (ulong)index + 1u] = a < b ? b : a;
    }
}

// Bodies that a work-group tests with each other: rows of one tile, and columns of another.
typedef struct {
    uint row, rows_end;
    uint column, columns;
} TilesOfBodies;

DEVICE TilesOfBodies tiles_of_bodies(TilePair pair, uint moving_count, uint body_count) {
    TilesOfBodies tiles;
    tiles.row = pair.row * BROAD_TILE;
    tiles.rows_end = moving_count - tiles.row < BROAD_TILE ? moving_count : tiles.row + BROAD_TILE;
    tiles.column = pair.column * BROAD_TILE;
    tiles.columns = body_count - tiles.column < BROAD_TILE ? body_count - tiles.column : BROAD_TILE;
    return tiles;
}

DEVICE TilesOfBodies no_bodies(uint moving_count, uint body_count) {
    const TilesOfBodies none = {moving_count, moving_count, body_count, 0};
    return none;
}

// Words shared by a work-group.
#define CHOSEN 0      // number of pairs of tiles to test
#define FOUND 1       // number of body pairs of one round
#define FIRST_INDEX 2 // index of the first of them in the output

// Each work-item of a group tests one pair of tiles, a fixed stride apart, and keeps it if the unions
// overlap. Then the group processes the kept pairs one by one, a work-item per row. One atomic addition per
// round. A single tile is read from the volumes, without a launch of bound_tiles. Loops with barriers run at
// least once, because PoCL 3.1 compiles other loops incorrectly.
KERNEL void find_body_pairs(GLOBAL const real* volumes, GLOBAL const RealPair* roots,
                            GLOBAL const RealPair* unions, GLOBAL const uint* order,
                            GLOBAL const uint* bodies, GLOBAL const uint* filters, uint body_count,
                            uint moving_count, GLOBAL const uint* list, uint listed, GLOBAL uint* pairs,
                            uint capacity, GLOBAL uint* status) {
    LOCAL_ARRAY(RealPair, columns, BROAD_TILE * DIRECTIONS);
    LOCAL_ARRAY(uint, chosen, GROUP_SIZE);
    LOCAL_ARRAY(uint, shared, 3);
    const uint tiles = (body_count + BROAD_TILE - 1u) / BROAD_TILE;
    const uint total = tile_pairs_in(tiles, moving_count, listed);
    const int is_only_tile = tiles == 1u;
    uint start = GROUP_ID;
    do {
        const uint tile_pair = start + LOCAL_ID * GROUP_COUNT;
        if (LOCAL_ID == 0u) shared[CHOSEN] = 0u;
        BARRIER;
        if (tile_pair < total
            && (is_only_tile || tiles_overlap(unions, tile_pair_of(list, tiles, tile_pair))))
            chosen[LOCAL_ATOMIC_ADD(shared + CHOSEN, 1u)] = tile_pair;
        BARRIER;
        const uint count = shared[CHOSEN];
        uint i = 0;
        do {
            const TilesOfBodies own =
                i < count ? tiles_of_bodies(tile_pair_of(list, tiles, chosen[i]), moving_count, body_count)
                          : no_bodies(moving_count, body_count);
            uint row = own.row + LOCAL_ID;
            uint rows_done = own.row;
            NO_UNROLL for (uint c = LOCAL_ID; c < own.columns; c += GROUP_SIZE) {
                UNROLL for (int axis = 0; axis < DIRECTIONS; ++axis) {
                    columns[c * DIRECTIONS + axis] = is_only_tile
                                                         ? slab_of(volumes, order, own.column + c, (uint)axis)
                                                         : roots[(ulong)(own.column + c) * DIRECTIONS + axis];
                }
            }
            do {
                if (LOCAL_ID == 0u) shared[FOUND] = 0u;
                BARRIER;
                uint hits = 0;
                if (row < own.rows_end) {
                    hits = overlapping_columns(roots, is_only_tile, row, columns, own.column, own.columns)
                           | own_column(volumes, bodies, order[row], row, own.column);
                    if (FILTERED) hits = filtered(filters, order[row], order + own.column, hits);
                }
                const uint offset = hits != 0u ? LOCAL_ATOMIC_ADD(shared + FOUND, COUNT_ONES(hits)) : 0u;
                BARRIER;
                if (LOCAL_ID == 0u && shared[FOUND] != 0u)
                    shared[FIRST_INDEX] = counter_add(status + STATUS_BODY_PAIRS, shared[FOUND]);
                BARRIER;
                if (hits != 0u)
                    write_pairs(pairs, capacity, shared[FIRST_INDEX] + offset, order[row], order + own.column,
                                hits);
                row += GROUP_SIZE;
                rows_done += GROUP_SIZE;
            } while (rows_done < own.rows_end);
            ++i;
        } while (i < count);
        start += GROUP_COUNT * GROUP_SIZE;
    } while (start < total);
}
