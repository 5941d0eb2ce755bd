// SPDX-License-Identifier: MIT
// The tiled walk: a team of lanes tests 32 boxes of one body against 32 of the other at once, without a
// stack. A launch processes the pairs of tiles of one level: those that the level above found, and those with
// which body pairs start there. It finds the pairs of the next level or, at level 0, candidate pairs.
// The walk waits for memory, so many groups at once pay; fewer registers than these make it use more memory.
// Host variants: AXES K PRECISION PRESSURE_SLAB SLABS=0|1, in lanes; of higher levels: PRECISION=32 SLABS=1
// or K=18 SLABS=1 or PRESSURE_SLAB=1 SLABS=1
#define BOX_WORDS (K * PRECISION / 32)
#define WALK_REGISTERS                                                                                       \
    (BOX_WORDS <= 6 ? 40 : BOX_WORDS <= 8 ? 56 : BOX_WORDS <= 12 ? 64 : BOX_WORDS <= 18 ? 72 : 255)
#define KERNEL_REGISTERS WALK_REGISTERS
#include "backends/portable.h"
#include "algorithms/tiled/decide.clh"

// Where a launch above level 0 finds boxes, and where it writes pairs of tiles. `marks`: one word per tile of
// level 0; those of the pairs found become 1 if `marked`.
typedef struct {
    GLOBAL const real* uppers;
    uint first_upper;
    uint level;
    GLOBAL uint* below;
    uint capacity;
    GLOBAL uint* marks;
    uint marked;
    GLOBAL uint* status;
} UpperWalk;

DEVICE void write_tile_pairs(const UpperWalk* walk, const Team* team, uint waiting) {
    const ulong start = *team->place;
    for (uint i = LANE_ID; i < waiting; i += (uint)LANE_STEP) {
        if (start + i >= walk->capacity) continue;
        const WordPair pair = team->pairs[i];
        ((GLOBAL WordPair*)walk->below)[start + i] = pair;
        if (walk->marked != 0u) walk->marks[pair.x] = walk->marks[pair.y] = 1u;
    }
}

// Loads the boxes of a tile for a level above 0: number `tile - first_upper` of the tiles with boxes of all
// directions. A tile of a lower level than the launch has its root as its only box.
DEVICE void load_boxes(const UpperWalk* walk, uint number, GLOBAL const real* root, const Tile* tile,
                       LANE_BOX(box, DIRECTIONS)) {
    GLOBAL const real* boxes = walk->uppers + (ulong)(number - walk->first_upper) * (K * LANES);
    const int whole = tile->level != walk->level;
    UNROLL for (uint word = 0; word < (uint)K; ++word) {
        FOR_LANES {
            const real nothing = word < (uint)DIRECTIONS ? REAL_INFINITY : -REAL_INFINITY;
            box[word][part] = !whole ? boxes[word * LANES + lane] : lane == 0u ? root[word] : nothing;
        }
    }
}

// load_sides() above level 0.
DEVICE void load_upper_sides(const UpperWalk* walk, GLOBAL const real* roots, Team* team, const Turn* turn,
                             LANE_BOX(box, DIRECTIONS), Sides* sides) {
    GLOBAL const real* root_a = root_of(roots, turn->pair.a);
    GLOBAL const real* root_b = root_of(roots, turn->pair.b);
    load_boxes(walk, turn->pair.b, root_b, &turn->b, box);
    LEAVE_OUT_APART(box, DIRECTIONS, root_a, sides->keeps_b)
    STORE_ROWS(team, rows_b, box, DIRECTIONS, sides->keeps_b)
    load_boxes(walk, turn->pair.a, root_a, &turn->a, box);
    LEAVE_OUT_APART(box, DIRECTIONS, root_b, sides->keeps_a)
    if (WINDOWED) lanes_in_window(walk->status, &turn->a, walk->level, sides->keeps_a);
}

// Appends hits to the waiting pairs, and writes these once they are enough. Box i of a has number first_a +
// i. A whole team calls it.
DEVICE void emit_tile_pairs(const UpperWalk* walk, Team* team, uint first_a, uint first_b, Sides* sides) {
    if (SELF && first_a == first_b) keep_ascending(sides);
    int more;
    do {
        put_hits(team, sides, first_a, first_b);
        more = hits_left(sides);
        LANE_BARRIER;
        const uint waiting = reserved_slots(&team->found);
        const int now = waiting >= PAIRS_FLUSHED;
        reserve(team, waiting, now, walk->status + STATUS_TILE_PAIRS + 2u * (walk->level - 1u));
        begin_rows(team);
        LANE_BARRIER;
        if (now) write_tile_pairs(walk, team, waiting);
        if (now) begin_count(&team->found, 0u);
        LANE_BARRIER;
    } while (more);
}

// Tests tiles of `level` or lower. Overlapping pairs go to `below`, the list of level - 1. `begins`: number
// of tiles with which a body starts on this level, or 0. `marked`: in a launch of level 1.
KERNEL void walk_upper_tiles(GLOBAL const real* uppers, uint first_upper, GLOBAL const real* roots,
                             GLOBAL const uint* tiles, GLOBAL const uint* tops, GLOBAL const uint* pairs,
                             uint pair_capacity, uint begins, uint level, GLOBAL const uint* list,
                             uint capacity, GLOBAL uint* below, uint below_capacity, GLOBAL uint* marks,
                             uint marked, GLOBAL uint* status) {
    TEAM_ARRAYS(LANES * ROW_UNITS(DIRECTIONS))
    const TileTables tables = {tiles, roots, pairs, tops, begins, list};
    const UpperWalk walk = {uppers, first_upper, level, below, below_capacity, marks, marked, status};
    Tally tally = empty_tally();
    Turns turns =
        first_turn(own_pairs(begins, pair_capacity, status), tile_pair_count(status, level, capacity));
    TilePair ahead = tile_pair_at(&tables, &turns);
    LANE_BARRIER;
    do { // runs at least once, as loops with barriers must
        const Turn turn = next_turn(&tables, &turns, &ahead);
        const uint highest = turn.a.level > turn.b.level ? turn.a.level : turn.b.level;
        const int tested = turn.pair.is_any && highest == level; // other pairs start in another launch
        Sides sides;
        begin_sides(&sides, tested);
        LANE_BOX(box, DIRECTIONS);
        if (tested) load_upper_sides(&walk, roots, &team, &turn, box, &sides);
        count_left(&team.left_a, sides.keeps_a);
        LANE_BARRIER;
        sides.by_a = rows_are_a(&team);
        const uint rows = row_count(&team);
        if (tested) count_tests(&tally, rows, turn.is_seed);
        if (TEAM_IS_FREE && rows == 0u) {
            begin_rows(&team);
            continue;
        }
        if (sides.by_a) {
            STORE_ROWS(&team, rows_a, box, DIRECTIONS, sides.keeps_a)
            load_boxes(&walk, turn.pair.b, root_of(roots, turn.pair.b), &turn.b, box);
            FOR_LANES sides.keeps_a[part] = sides.keeps_b[part];
        }
        end_rows(&team, rows);
        LANE_BARRIER;
        // The boxes of a tile are the tiles below, or the tile itself is its only box. Known before the rows
        // are tested, these two take fewer registers.
        const uint first_a = turn.a.level == level ? turn.a.boxes : turn.pair.a;
        const uint first_b = turn.b.level == level ? turn.b.boxes : turn.pair.b;
        FIND_HITS(&team, rows, box, DIRECTIONS, sides.keeps_a, sides.hits)
        emit_tile_pairs(&walk, &team, first_a, first_b, &sides);
    } while (turns.next < turn_count(&turns));
    const uint waiting = reserved_slots(&team.found);
    reserve(&team, waiting, 1, status + STATUS_TILE_PAIRS + 2u * (level - 1u));
    LANE_BARRIER;
    write_tile_pairs(&walk, &team, waiting);
    if (COUNT_WORK) counter_add_wide(status + STATUS_UPPER_TESTS, tally.tests);
    if (COUNT_WORK) flush(&tally, status);
}

// Appends hits to the waiting pairs, decides them, and writes candidate pairs once they are enough. A whole
// team calls it.
DEVICE void emit_leaf_pairs(const LeafWalk* walk, Team* team, const Turn* turn, Sides* sides, Rest* rest,
                            Tally* tally) {
    int more;
    do {
        put_hits(team, sides, turn->pair.a * LANES, turn->pair.b * LANES);
        more = hits_left(sides);
        LANE_BARRIER;
        const uint found = reserved_slots(&team->found);
        begin_rows(team);
        if (!IS_DECIDED) {
            load_rest(&walk->shapes, turn, found > reserved_slots(&team->kept), rest);
            decide_pairs(walk, team, turn, rest, found, tally);
        }
        const uint kept = IS_DECIDED ? found : reserved_slots(&team->kept);
        const int now = kept >= PAIRS_FLUSHED;
        reserve(team, kept, now, walk->status + STATUS_PAIRS);
        LANE_BARRIER;
        if (now) write_found(walk, team, kept);
        begin_count(&team->found, now ? 0u : kept);
        begin_count(&team->kept, now ? 0u : kept);
        LANE_BARRIER;
    } while (more);
}

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
                            GLOBAL const real* vertices, float margin, GLOBAL const uint* ids,
                            GLOBAL const uint* incident_starts, GLOBAL const uint* incident_partners,
                            GLOBAL const uint* incident_masks, GLOBAL uint* found, uint capacity,
                            GLOBAL uint* status) {
    TEAM_ARRAYS(LANES * ROW_UNITS(TESTED_DIRECTIONS))
    REST_ARRAYS
    const LeafWalk walk = {leaves,
                           {tiles, roots, pairs, tops, begins, list},
                           {incident_starts, incident_partners, incident_masks},
                           {starts, vertex_numbers, corners, bodies, poses, vertices, margin},
                           ids,
                           found,
                           capacity,
                           status};
    Tally tally = empty_tally();
    Turns turns =
        first_turn(own_pairs(begins, pair_capacity, status), tile_pair_count(status, 0u, list_capacity));
    LANE_BOX(box, TESTED_DIRECTIONS);
    uint box_of = NO_TILE; // tile of `box`
    TilePair ahead = tile_pair_at(&walk.tables, &turns);
    LANE_BARRIER;
    do { // runs at least once, as loops with barriers must
        const Turn turn = next_turn(&walk.tables, &turns, &ahead);
        // Other pairs start in another launch. Those that the level above found are of this one.
        const int tested = turn.pair.is_any && (!turn.is_seed || (turn.a.level | turn.b.level) == 0u);
        Sides sides;
        begin_sides(&sides, tested);
        const int has_masks = tested ? load_sides(&walk, &team, &turn, &box_of, box, &sides) : 0;
        count_left(&team.left_a, sides.keeps_a);
        LANE_BARRIER;
        sides.by_a = !has_masks && rows_are_a(&team);
        const uint rows = has_masks ? row_count_of_b(&team) : row_count(&team);
        if (tested) count_tests(&tally, rows, turn.is_seed);
        if (TEAM_IS_FREE && rows == 0u) {
            begin_rows(&team);
            continue;
        }
        if (sides.by_a) {
            STORE_ROWS(&team, rows_a, box, TESTED_DIRECTIONS, sides.keeps_a)
            load_leaves(leaves, turn.pair.b, box);
            box_of = turn.pair.b;
            FOR_LANES sides.keeps_a[part] = sides.keeps_b[part];
        }
        end_rows(&team, rows);
        LANE_BARRIER;
        FIND_HITS(&team, rows, box, TESTED_DIRECTIONS, sides.keeps_a, sides.hits)
        if (SELF) FOR_LANES sides.hits[part] &= ~sides.no_pairs[part];
        emit_leaf_pairs(&walk, &team, &turn, &sides, &rest, &tally);
    } while (turns.next < turn_count(&turns));
    const uint kept = reserved_slots(&team.found);
    reserve(&team, kept, 1, status + STATUS_PAIRS);
    LANE_BARRIER;
    if (OUTPUT == OUTPUT_PAIRS) write_found(&walk, &team, kept);
    flush(&tally, status);
}
