// SPDX-License-Identifier: MIT
// The tiled walk: a team of lanes tests 32 boxes of one body against 32 of the other at once, without a
// stack. A launch processes the pairs of tiles of one level: those that the level above found, and those with
// which body pairs start there. It finds the pairs of the next level or, at level 0, candidate pairs.
// The walk waits for memory, so many groups at once pay; fewer registers than these make it use more memory.
#define BOX_WORDS (K * PRECISION / 32)
#define WALK_REGISTERS                                                                                       \
    (BOX_WORDS <= 6 ? 40 : BOX_WORDS <= 8 ? 56 : BOX_WORDS <= 12 ? 64 : BOX_WORDS <= 18 ? 72 : 255)
#define KERNEL_REGISTERS WALK_REGISTERS
#include "backends/portable.h"
#include "algorithms/answer/emit.clh"
#include "algorithms/tiled/incidence.clh"

// Directions along which all boxes of two tiles of level 0 are tested. With pairs of one body there are many
// pairs of tiles, but masks leave few hits, so that a test of three directions and then of hits is less work.
#if defined(__CUDACC__) || defined(__OPENCL_C_VERSION__)
#define TESTED_DIRECTIONS (SELF && LEAF_DIRECTIONS > 3 ? 3 : LEAF_DIRECTIONS)
#else // SELF is no constant
#define TESTED_DIRECTIONS LEAF_DIRECTIONS
#endif
#include "algorithms/tiled/leaves.clh"

// Tables that name slots.
typedef struct {
    GLOBAL const uint* tiles;
    GLOBAL const uint* bodies;
    GLOBAL const uint* ids;
} SlotTables;

// Two slots; those of one body with the smaller number of a tetrahedron first.
DEVICE WordPair smaller_first(const SlotTables* tables, WordPair slots) {
    WordRow pair = items_of_slots(tables->tiles, slots.x, slots.y);
    if (pair.x != pair.y) return slots;
    const uint item_a = pair.z;
    put_smaller_first(tables->bodies, tables->ids, &pair);
    const WordPair swapped = {slots.y, slots.x};
    return pair.z == item_a ? slots : swapped;
}

// Writes the waiting pairs of the team as candidate pairs, and nothing past `capacity`.
DEVICE void write_found(const Team* team, uint waiting, const SlotTables* tables, GLOBAL uint* found,
                        uint capacity) {
    if (SELF)
        for (uint i = LANE_ID; i < waiting; i += (uint)LANE_STEP)
            team->pairs[i] = smaller_first(tables, team->pairs[i]);
    write_candidates(team, waiting, tables->tiles, found, capacity);
}

// `marks`: set for both tiles if `marked`.
DEVICE void write_tile_pairs(const Team* team, uint waiting, GLOBAL uint* list, uint capacity,
                             GLOBAL uint* marks, uint marked) {
    const ulong start = *team->place;
    for (uint i = LANE_ID; i < waiting; i += (uint)LANE_STEP) {
        if (start + i >= capacity) continue;
        const WordPair pair = team->pairs[i];
        ((GLOBAL WordPair*)list)[start + i] = pair;
        if (marked != 0u) marks[pair.x] = marks[pair.y] = 1u;
    }
}

// Loads the boxes of a tile for a level above 0: number `upper` of the tiles with boxes of all directions. A
// tile of a lower level than the launch has its root as its only box.
DEVICE void load_boxes(GLOBAL const real* uppers, uint upper, GLOBAL const real* root, const Tile* tile,
                       uint level, LANE_BOX(box, DIRECTIONS)) {
    GLOBAL const real* boxes = uppers + (ulong)upper * (K * LANES);
    const int whole = tile->level != level;
    UNROLL for (uint word = 0; word < (uint)K; ++word) {
        FOR_LANES {
            const real nothing = word < (uint)DIRECTIONS ? REAL_INFINITY : -REAL_INFINITY;
            box[word][part] = !whole ? boxes[word * LANES + lane] : lane == 0u ? root[word] : nothing;
        }
    }
}

// Tests tiles of `level` or lower. Overlapping pairs go to `below`, the list of level - 1. `begins`: number
// of tiles with which a body starts on this level, or 0. `marks`: one word per tile of level 0; in a launch
// of level 1 with `marked`, those of the pairs found become 1.
KERNEL void walk_upper_tiles(GLOBAL const real* uppers, uint first_upper, GLOBAL const real* roots,
                             GLOBAL const uint* tiles, GLOBAL const uint* tops, GLOBAL const uint* pairs,
                             uint pair_capacity, uint begins, uint level, GLOBAL const uint* list,
                             uint capacity, GLOBAL uint* below, uint below_capacity, GLOBAL uint* marks,
                             uint marked, GLOBAL uint* status) {
    TEAM_ARRAYS(LANES * ROW_UNITS(DIRECTIONS))
    GLOBAL uint* counter = status + STATUS_TILE_PAIRS + 2u * (level - 1u);
    Tally tally = empty_tally();
    Turns turns =
        first_turn(own_pairs(begins, pair_capacity, status), tile_pair_count(status, level, capacity));
    TilePair ahead = tile_pair_at(&turns, pairs, tops, begins, roots, list);
    LANE_BARRIER;
    do { // runs at least once, as loops with barriers must
        const TilePair pair = ahead;
        const int is_seed = turns.next < turns.own;
        take_turn(&turns);
        ahead = tile_pair_at(&turns, pairs, tops, begins, roots, list); // read before it is needed
        const Tile a = tile_at(tiles, pair.a);
        const Tile b = tile_at(tiles, pair.b);
        const int highest = a.level > b.level ? a.level == level : b.level == level;
        const int tested = pair.is_any && highest; // other pairs start in another launch
        uint keeps_a[LANE_PARTS];
        uint keeps_b[LANE_PARTS];
        FOR_LANES keeps_a[part] = keeps_b[part] = (uint)tested;
        LANE_BOX(box, DIRECTIONS);
        if (tested) {
            GLOBAL const real* root_a = root_of(roots, pair.a);
            GLOBAL const real* root_b = root_of(roots, pair.b);
            load_boxes(uppers, pair.b - first_upper, root_b, &b, level, box);
            LEAVE_OUT_APART(box, DIRECTIONS, root_a, keeps_b)
            STORE_ROWS(&team, rows_b, box, DIRECTIONS, keeps_b)
            load_boxes(uppers, pair.a - first_upper, root_a, &a, level, box);
            LEAVE_OUT_APART(box, DIRECTIONS, root_b, keeps_a)
            if (WINDOWED) lanes_in_window(status, &a, level, keeps_a);
        }
        count_left(&team.left_a, keeps_a);
        LANE_BARRIER;
        const int by_a = rows_are_a(&team);
        const uint rows = row_count(&team);
        if (tested) count_tests(&tally, rows, is_seed);
        if (TEAM_IS_FREE && rows == 0u) {
            begin_rows(&team);
            continue;
        }
        if (by_a) {
            STORE_ROWS(&team, rows_a, box, DIRECTIONS, keeps_a)
            load_boxes(uppers, pair.b - first_upper, root_of(roots, pair.b), &b, level, box);
            FOR_LANES keeps_a[part] = keeps_b[part];
        }
        end_rows(&team, rows);
        LANE_BARRIER;
        // The boxes of a tile are the tiles below, or the tile itself is its only box.
        const uint first_a = a.level == level ? a.boxes : pair.a;
        const uint first_b = b.level == level ? b.boxes : pair.b;
        uint hits[LANE_PARTS];
        FOR_LANES hits[part] = 0u;
        FIND_HITS(&team, rows, box, DIRECTIONS, keeps_a, hits)
        if (SELF && first_a == first_b) keep_ascending(hits, by_a);
        int more;
        do {
            put_hits(&team, hits, first_a, first_b, by_a);
            more = hits_left(hits);
            LANE_BARRIER;
            const uint waiting = reserved_slots(&team.found);
            const int now = waiting >= PAIRS_FLUSHED;
            reserve(&team, waiting, now, counter);
            begin_rows(&team);
            LANE_BARRIER;
            if (now) write_tile_pairs(&team, waiting, below, below_capacity, marks, marked);
            if (now) begin_count(&team.found, 0u);
            LANE_BARRIER;
        } while (more);
    } while (turns.next < turn_count(&turns));
    const uint waiting = reserved_slots(&team.found);
    reserve(&team, waiting, 1, counter);
    LANE_BARRIER;
    write_tile_pairs(&team, waiting, below, below_capacity, marks, marked);
    if (COUNT_WORK) counter_add_wide(status + STATUS_UPPER_TESTS, tally.tests);
    if (COUNT_WORK) flush(&tally, status);
}

#if REST_DIRECTIONS > 0
// Slabs along the directions that leaves do not store, in local memory. Those of b are computed last and
// overwrite the vertices of b.
#define REST_WORDS (2 * REST_DIRECTIONS)
#define REST_STRIDE (REST_WORDS | 1)
#define REST_A_REALS (LANES * REST_STRIDE)
#define REST_B_REALS (REST_A_REALS > MOST_VERTICES * POINT_REALS ? REST_A_REALS : MOST_VERTICES * POINT_REALS)

DEVICE void rest_slabs(const Shapes* shapes, const Tile* tile, LOCAL const real* points,
                       real rest[REST_WORDS][LANE_PARTS]) {
    const Point drift = drift_at(shapes->poses, tile->body);
    FOR_LANES {
        real slabs[K];
        bound_corners(shapes, tile, points, lane, drift, slabs);
        UNROLL for (uint d = 0; d < (uint)REST_DIRECTIONS; ++d) {
            rest[d][part] = slabs[LEAF_DIRECTIONS + d];
            rest[REST_DIRECTIONS + d][part] = slabs[DIRECTIONS + LEAF_DIRECTIONS + d];
        }
    }
}

DEVICE void keep_rest(real rest[REST_WORDS][LANE_PARTS], LOCAL real* kept) {
    FOR_LANES {
        UNROLL for (uint word = 0; word < (uint)REST_WORDS; ++word) {
            kept[lane * REST_STRIDE + word] = rest[word][part];
        }
    }
}

DEVICE int rest_overlaps(LOCAL const real* a, LOCAL const real* b) {
    uint apart = 0;
    UNROLL for (uint d = 0; d < (uint)REST_DIRECTIONS; ++d) apart |=
        (uint)APART(a[d], a[REST_DIRECTIONS + d], b[d], b[REST_DIRECTIONS + d]);
    return apart == 0u;
}
#endif

// Whether the boxes of two slots overlap along the stored directions from TESTED_DIRECTIONS on. Three at a
// time, because most of these pairs are apart.
DEVICE int other_directions_overlap(GLOBAL const real* leaves, uint slot_a, uint slot_b) {
    GLOBAL const real* a = leaves_of(leaves, slot_a / LANES) + slot_a % LANES;
    GLOBAL const real* b = leaves_of(leaves, slot_b / LANES) + slot_b % LANES;
    uint apart = 0;
    for (uint first = TESTED_DIRECTIONS; first < (uint)LEAF_DIRECTIONS && apart == 0u; first += 3u) {
        UNROLL for (uint i = 0; i < 3u; ++i) {
            const uint d = first + i < (uint)LEAF_DIRECTIONS ? first + i : first;
            apart |= (uint)APART(a[d * LANES], a[(LEAF_DIRECTIONS + d) * LANES], b[d * LANES],
                                 b[(LEAF_DIRECTIONS + d) * LANES]);
        }
    }
    return apart == 0u;
}

// Whether every pair found is a candidate pair.
#define IS_DECIDED (TESTED_DIRECTIONS == DIRECTIONS && OUTPUT == OUTPUT_PAIRS)

#undef KERNEL_REGISTERS
#define KERNEL_REGISTERS                                                                                     \
    (TESTED_DIRECTIONS == LEAF_DIRECTIONS ? WALK_REGISTERS                                                   \
     : PRECISION == 64                    ? 80                                                               \
     : OUTPUT == OUTPUT_PAIRS             ? 48                                                               \
                                          : 56)
// Tests tiles of level 0: boxes that overlap along all directions of k are candidate pairs.
KERNEL void walk_leaf_tiles(GLOBAL const real* leaves, GLOBAL const real* roots, GLOBAL const uint* tiles,
                            GLOBAL const uint* tops, GLOBAL const uint* pairs, uint pair_capacity,
                            uint begins, GLOBAL const uint* list, uint list_capacity,
                            GLOBAL const uint* starts, GLOBAL const uint* vertex_numbers,
                            GLOBAL const uint* corners, GLOBAL const uint* bodies, GLOBAL const real* poses,
                            GLOBAL const real* vertices, GLOBAL const uint* ids,
                            GLOBAL const uint* incident_starts, GLOBAL const uint* incident_partners,
                            GLOBAL const uint* incident_masks, GLOBAL uint* found, uint capacity,
                            GLOBAL uint* status) {
    TEAM_ARRAYS(LANES * ROW_UNITS(TESTED_DIRECTIONS))
    const SlotTables tables = {tiles, bodies, ids};
    const Incidence incidence = {incident_starts, incident_partners, incident_masks};
#if REST_DIRECTIONS > 0
    LOCAL_ARRAY(real, all_rest, LANE_TEAMS * (REST_A_REALS + REST_B_REALS));
    LOCAL real* rest_a = all_rest + LANE_TEAM * (REST_A_REALS + REST_B_REALS);
    LOCAL real* rest_b = rest_a + REST_A_REALS;
    const Shapes shapes = {starts, vertex_numbers, corners, bodies, poses, vertices};
    uint rest_of = 0xffffffffu; // tile of rest_a
#endif
    Tally tally = empty_tally();
    Turns turns =
        first_turn(own_pairs(begins, pair_capacity, status), tile_pair_count(status, 0u, list_capacity));
    LANE_BOX(box, TESTED_DIRECTIONS);
    uint box_of = 0xffffffffu; // tile of `box`
    TilePair ahead = tile_pair_at(&turns, pairs, tops, begins, roots, list);
    LANE_BARRIER;
    do { // runs at least once, as loops with barriers must
        const TilePair pair = ahead;
        const int is_seed = turns.next < turns.own;
        take_turn(&turns);
        ahead = tile_pair_at(&turns, pairs, tops, begins, roots, list); // read before it is needed
        const Tile a = tile_at(tiles, pair.a);
        const Tile b = tile_at(tiles, pair.b);
        // Other pairs start in another launch. Those that the level above found are of this one.
        const int tested = pair.is_any && (!is_seed || (a.level == 0u && b.level == 0u));
        uint keeps_a[LANE_PARTS];
        uint keeps_b[LANE_PARTS];
        FOR_LANES keeps_a[part] = keeps_b[part] = (uint)tested;
        uint no_pairs[LANE_PARTS]; // bits of the lanes of b with which a lane of a makes no pair
        FOR_LANES no_pairs[part] = 0u;
        int has_masks = 0; // the masks are those of a's lanes, so that rows must be boxes of b
        if (tested) {
            LANE_BOX(box_b, TESTED_DIRECTIONS);
            load_leaves(leaves, pair.b, box_b);
            if (box_of != pair.a) load_leaves(leaves, pair.a, box);
            box_of = pair.a;
            GLOBAL const real* root_a = root_of(roots, pair.a);
            LEAVE_OUT_APART(box_b, TESTED_DIRECTIONS, root_a, keeps_b)
            STORE_ROWS(&team, rows_b, box_b, TESTED_DIRECTIONS, keeps_b)
            GLOBAL const real* root_b = root_of(roots, pair.b);
            LEAVE_OUT_APART(box, TESTED_DIRECTIONS, root_b, keeps_a)
            if (WINDOWED) lanes_in_window(status, &a, 0u, keeps_a);
            if (SELF && a.body == b.body) {
                has_masks = load_masks(&incidence, a.boxes, b.boxes, no_pairs);
                FOR_LANES keeps_a[part] &= (uint)(no_pairs[part] != 0xffffffffu);
            }
        }
        count_left(&team.left_a, keeps_a);
        LANE_BARRIER;
        const int by_a = SELF && has_masks ? 0 : rows_are_a(&team);
        const uint rows = SELF && has_masks ? row_count_of_b(&team) : row_count(&team);
        if (tested) count_tests(&tally, rows, is_seed);
        if (TEAM_IS_FREE && rows == 0u) {
            begin_rows(&team);
            continue;
        }
        if (by_a) {
            STORE_ROWS(&team, rows_a, box, TESTED_DIRECTIONS, keeps_a)
            load_leaves(leaves, pair.b, box);
            box_of = pair.b;
            FOR_LANES keeps_a[part] = keeps_b[part];
        }
        end_rows(&team, rows);
        LANE_BARRIER;
        uint hits[LANE_PARTS];
        FOR_LANES hits[part] = 0u;
        FIND_HITS(&team, rows, box, TESTED_DIRECTIONS, keeps_a, hits)
        if (SELF) FOR_LANES hits[part] &= ~no_pairs[part];
        int more;
        do {
            put_hits(&team, hits, pair.a * LANES, pair.b * LANES, by_a);
            more = hits_left(hits);
            LANE_BARRIER;
            const uint candidates = reserved_slots(&team.found);
            begin_rows(&team);
            uint kept = candidates;
            if (!IS_DECIDED) {
                uint next = reserved_slots(&team.kept);
#if REST_DIRECTIONS > 0
                const int decides = candidates > next;
                const int decides_a = decides && rest_of != pair.a;
                real rest[REST_WORDS][LANE_PARTS];
                if (decides_a) load_vertices(&shapes, &a, rest_b);
                LANE_BARRIER;
                if (decides_a) rest_slabs(&shapes, &a, rest_b, rest);
                LANE_BARRIER;
                if (decides_a) keep_rest(rest, rest_a);
                rest_of = decides_a ? pair.a : rest_of;
                if (decides) load_vertices(&shapes, &b, rest_b);
                LANE_BARRIER;
                if (decides) rest_slabs(&shapes, &b, rest_b, rest);
                LANE_BARRIER;
                if (decides) keep_rest(rest, rest_b);
                LANE_BARRIER;
#endif
                do {
                    uint slot_a[LANE_PARTS];
                    uint slot_b[LANE_PARTS];
                    FOR_LANES {
                        const uint at = next + lane < candidates ? next + lane : 0u;
                        slot_a[part] = team.pairs[at].x;
                        slot_b[part] = team.pairs[at].y;
                    }
                    LANE_BARRIER;
                    FOR_LANES {
                        int is_pair = next + lane < candidates;
                        const uint lane_a = slot_a[part] % LANES;
                        const uint lane_b = slot_b[part] % LANES;
#if REST_DIRECTIONS > 0
                        is_pair =
                            is_pair
                            && rest_overlaps(rest_a + lane_a * REST_STRIDE, rest_b + lane_b * REST_STRIDE);
#endif
                        if (TESTED_DIRECTIONS < LEAF_DIRECTIONS)
                            is_pair = is_pair && other_directions_overlap(leaves, slot_a[part], slot_b[part]);
                        if (OUTPUT == OUTPUT_PAIRS) {
                            const uint slot = reserve_slot(&team.kept, is_pair);
                            const WordPair kept_pair = {slot_a[part], slot_b[part]};
                            if (is_pair) team.pairs[slot] = kept_pair;
                        } else if (is_pair) {
                            tally.count += 1;
                            WordRow row = {a.body, b.body, a.item + lane_a, b.item + lane_b};
                            if (OUTPUT == OUTPUT_DIGEST) {
                                if (SELF && row.x == row.y) put_smaller_first(bodies, ids, &row);
                                tally_digest(&tally, bodies, ids, row);
                            }
                        }
                    }
                    next += LANES;
                    LANE_BARRIER;
                } while (next < candidates);
                kept = reserved_slots(&team.kept);
            }
            const int now = kept >= PAIRS_FLUSHED;
            reserve(&team, kept, now, status + STATUS_PAIRS);
            LANE_BARRIER;
            if (now) write_found(&team, kept, &tables, found, capacity);
            begin_count(&team.found, now ? 0u : kept);
            begin_count(&team.kept, now ? 0u : kept);
            LANE_BARRIER;
        } while (more);
    } while (turns.next < turn_count(&turns));
    const uint kept = reserved_slots(&team.found);
    reserve(&team, kept, 1, status + STATUS_PAIRS);
    LANE_BARRIER;
    if (OUTPUT == OUTPUT_PAIRS) write_found(&team, kept, &tables, found, capacity);
    flush(&tally, status);
}
