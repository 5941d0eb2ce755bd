// SPDX-License-Identifier: MIT
// The last level of a walk, which makes a list or finds candidate pairs directly, and the answer from a list.
// A list has two parts. Certain pairs overlap as long as the list is valid. Open pairs may: each frame tests
// them along the directions that are open. Rows of both parts are slots (rows.clh).
#define WHOLE_LEAVES
#define BOX_WORDS (K * PRECISION / 32)
#define KERNEL_REGISTERS (BOX_WORDS <= 8 ? 64 : BOX_WORDS <= 12 ? 80 : BOX_WORDS <= 18 ? 96 : 255)
#include "backends/portable.h"
#include "algorithms/listed/pad.clh"
#define TESTED_DIRECTIONS LEAF_DIRECTIONS
#include "algorithms/tiled/leaves.clh"

// A list, and what a walk appends to it.
typedef struct {
    GLOBAL WordPair* certain;
    GLOBAL WordPair* open;
    GLOBAL uint* directions; // of open pairs: bit d is set if direction d is open
    uint certain_capacity, open_capacity;
} List;

DEVICE uint list_length(GLOBAL const uint* state, uint counter, uint capacity) {
    return state[counter + 1u] != 0u || state[counter] > capacity ? capacity : state[counter];
}

// Loads the leaves of a tile. When the walk makes a list, they are enlarged by its pad.
DEVICE void load_padded(GLOBAL const real* leaves, uint tile, int is_padded, const real* by,
                        LANE_BOX(box, DIRECTIONS)) {
    load_leaves(leaves, tile, box);
    if (!is_padded) return;
    UNROLL for (uint word = 0; word < (uint)K; ++word) {
        const real out = by[word % (uint)DIRECTIONS];
        FOR_LANES box[word][part] = moved_out(box[word][part], out, word >= (uint)DIRECTIONS);
    }
}

// The end number `word` of a tetrahedron's bounds.
DEVICE GLOBAL const real* leaf_of(GLOBAL const real* leaves, uint slot) {
    return leaves_of(leaves, slot / LANES) + slot % LANES;
}

// The movement of ends by direction, of a list with this pad.
DEVICE void movements(real pad, real* by) {
    UNROLL for (uint d = 0; d < (uint)DIRECTIONS; ++d) by[d] = movement(pad, d);
}

// The directions along which two tetrahedra may stop to overlap while the list is valid.
DEVICE uint open_directions(GLOBAL const real* leaves, uint slot_a, uint slot_b, const real* by) {
    GLOBAL const real* a = leaf_of(leaves, slot_a);
    GLOBAL const real* b = leaf_of(leaves, slot_b);
    uint open = 0;
    UNROLL for (uint d = 0; d < (uint)DIRECTIONS; ++d) {
        const int stay = stays_below(a[d * LANES], b[(DIRECTIONS + d) * LANES], by[d])
                         & stays_below(b[d * LANES], a[(DIRECTIONS + d) * LANES], by[d]);
        open |= (stay ? 0u : 1u) << d;
    }
    return open;
}

// Whether two tetrahedra overlap along these directions.
DEVICE int overlaps_along(GLOBAL const real* leaves, WordPair pair, uint directions) {
    GLOBAL const real* a = leaf_of(leaves, pair.x);
    GLOBAL const real* b = leaf_of(leaves, pair.y);
    uint apart = 0;
    for (; directions != 0u && apart == 0u; directions &= directions - 1u) {
        const uint lower = (31u - COUNT_LEADING_ZEROS(directions & (0u - directions))) * LANES;
        const uint upper = lower + (uint)(DIRECTIONS * LANES);
        apart = (uint)APART(a[lower], a[upper], b[lower], b[upper]);
    }
    return apart == 0u;
}

// Writes the open pairs of the lanes, up to the capacity. `opened` numbers them; `place` gets the first
// index.
DEVICE void write_open(const List* list, LaneCounter* opened, LOCAL uint* place, GLOBAL uint* state,
                       const WordPair* pairs, const uint* open) {
    uint slot[LANE_PARTS];
    FOR_LANES slot[part] = reserve_slot(opened, open[part] != 0u);
    LANE_BARRIER;
    const uint count = reserved_slots(opened);
    if (LANE_ID == 0u) *place = count != 0u ? counter_add(state + STATE_OPEN, count) : 0u;
    LANE_BARRIER;
    FOR_LANES {
        const ulong at = (ulong)*place + slot[part];
        if (open[part] == 0u || at >= list->open_capacity) continue;
        list->open[at] = pairs[part];
        list->directions[at] = open[part];
    }
    begin_count(opened, 0u);
}

// Counts certain pairs of a new list as pairs of the answer, where they are the first ones.
DEVICE void count_certain(uint count, GLOBAL uint* status) {
    if (OUTPUT == OUTPUT_PAIRS && LANE_ID == 0u && count != 0u) counter_add(status + STATUS_PAIRS, count);
}

// Tests tiles of level 0, as walk_leaf_tiles of tiled.cl with bounds along all directions. A run without a
// list writes candidate pairs to `found`. `walked`: the status of the walk (decide_list).
KERNEL void list_leaf_tiles(GLOBAL const real* leaves, GLOBAL const real* roots, GLOBAL const uint* tiles,
                            GLOBAL const uint* tops, GLOBAL const uint* pairs, uint pair_capacity,
                            uint begins, GLOBAL const uint* list, uint list_capacity,
                            GLOBAL const uint* bodies, GLOBAL const uint* ids, GLOBAL const uint* tetrahedra,
                            GLOBAL uint* found, uint capacity, GLOBAL uint* certain, uint certain_capacity,
                            GLOBAL uint* open, GLOBAL uint* directions, uint open_capacity,
                            GLOBAL const real* pads, GLOBAL uint* state, GLOBAL uint* walked,
                            GLOBAL uint* status) {
    TEAM_ARRAYS(LANES * ROW_UNITS(DIRECTIONS))
    LOCAL_ARRAY(uint, open_words, LANE_TEAMS * 2);
    LaneCounter opened;
    opened.word = open_words + LANE_TEAM * 2u;
    begin_count(&opened, 0u);
    if (LANE_ID == 0u) *team.place = 0u; // g++ does not see that it is written before it is read
    const List kept_list = {(GLOBAL WordPair*)certain, (GLOBAL WordPair*)open, directions, certain_capacity,
                            open_capacity};
    const int lists = state[STATE_RUN] == FRAME_LIST;
    real by[DIRECTIONS];
    movements(pad_of(state, pads), by);
    Tally tally = empty_tally();
    Turns turns =
        first_turn(own_pairs(begins, pair_capacity, walked), tile_pair_count(walked, 0u, list_capacity));
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
        LANE_BOX(box, DIRECTIONS);
        if (tested) {
            load_padded(leaves, pair.b, lists, by, box);
            GLOBAL const real* root_a = root_of(roots, pair.a);
            LEAVE_OUT_APART(box, DIRECTIONS, root_a, keeps_b)
            STORE_ROWS(&team, rows_b, box, DIRECTIONS, keeps_b)
            load_padded(leaves, pair.a, lists, by, box);
            GLOBAL const real* root_b = root_of(roots, pair.b);
            LEAVE_OUT_APART(box, DIRECTIONS, root_b, keeps_a)
            if (WINDOWED) lanes_in_window(walked, &a, 0u, keeps_a);
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
            load_padded(leaves, pair.b, lists, by, box);
            FOR_LANES keeps_a[part] = keeps_b[part];
        }
        end_rows(&team, rows);
        LANE_BARRIER;
        uint hits[LANE_PARTS];
        FOR_LANES hits[part] = 0u;
        FIND_HITS(&team, rows, box, DIRECTIONS, keeps_a, hits)
        if (SELF && pair.a == pair.b) keep_ascending(hits, by_a);
        int more;
        do {
            put_hits(&team, hits, pair.a * LANES, pair.b * LANES, by_a);
            more = hits_left(hits);
            LANE_BARRIER;
            const uint candidates = reserved_slots(&team.found);
            begin_rows(&team);
            uint kept = candidates;
            if (OUTPUT != OUTPUT_PAIRS || SELF || lists) {
                uint next = reserved_slots(&team.kept);
                do {
                    WordPair slots[LANE_PARTS];
                    FOR_LANES slots[part] = team.pairs[next + lane < candidates ? next + lane : 0u];
                    LANE_BARRIER;
                    uint opens[LANE_PARTS];
                    FOR_LANES {
                        int is_pair = next + lane < candidates;
                        opens[part] = 0u;
                        const uint lane_a = slots[part].x % LANES;
                        const uint lane_b = slots[part].y % LANES;
                        WordRow row = {a.body, b.body, a.item + lane_a, b.item + lane_b};
                        if (lists && is_pair)
                            opens[part] = open_directions(leaves, slots[part].x, slots[part].y, by);
                        if (SELF && row.x == row.y)
                            is_pair = is_pair && keep_self_pair(bodies, tetrahedra, ids, &row);
                        if (SELF && row.z > row.w && row.x == row.y) {
                            const WordPair swapped = {slots[part].y, slots[part].x};
                            slots[part] = swapped;
                        }
                        opens[part] = is_pair ? opens[part] : 0u;
                        if (OUTPUT == OUTPUT_PAIRS || lists) {
                            const int is_kept = is_pair && opens[part] == 0u;
                            const uint slot = reserve_slot(&team.kept, is_kept);
                            if (is_kept) team.pairs[slot] = slots[part];
                        } else if (is_pair) {
                            tally.count += 1;
                            if (OUTPUT == OUTPUT_DIGEST) tally_digest(&tally, bodies, ids, row);
                        }
                    }
                    if (lists)
                        write_open(&kept_list, &opened, open_words + LANE_TEAM * 2u + 1u, state, slots,
                                   opens);
                    next += LANES;
                    LANE_BARRIER;
                } while (next < candidates);
                kept = reserved_slots(&team.kept);
            }
            const int now = kept >= PAIRS_FLUSHED;
            reserve(&team, kept, now, lists ? state + STATE_CERTAIN : status + STATUS_PAIRS);
            if (now && lists) count_certain(kept, status);
            LANE_BARRIER;
            if (now && lists) write_rows(&team, kept, kept_list.certain, certain_capacity);
            if (now && !lists) write_candidates(&team, kept, tiles, found, capacity);
            begin_count(&team.found, now ? 0u : kept);
            begin_count(&team.kept, now ? 0u : kept);
            LANE_BARRIER;
        } while (more);
    } while (turns.next < turn_count(&turns));
    const uint kept = reserved_slots(&team.found);
    reserve(&team, kept, 1, lists ? state + STATE_CERTAIN : status + STATUS_PAIRS);
    if (lists) count_certain(kept, status);
    LANE_BARRIER;
    if (lists) write_rows(&team, kept, kept_list.certain, certain_capacity);
    if (OUTPUT == OUTPUT_PAIRS && !lists) write_candidates(&team, kept, tiles, found, capacity);
    flush(&tally, status);
}

// Copies `count` rows if the frame is the first of a list, or has none.
DEVICE void save(GLOBAL const real* from, GLOBAL real* to, uint count) {
    for (uint i = GLOBAL_ID; i < count; i += GLOBAL_COUNT)
        ((GLOBAL RealRow*)to)[i] = ((GLOBAL const RealRow*)from)[i];
}

// Copies what the walk of the list has counted to the status of the frame.
DEVICE void copy_counts(GLOBAL const uint* state, GLOBAL const uint* walked, GLOBAL uint* status) {
    if (GLOBAL_ID != 0u) return;
    for (uint i = 0; i < STATUS_COPIED_WORDS; ++i) status[STATUS_OWN + i] = walked[STATUS_OWN + i];
    for (uint i = 0; i < 2u; ++i) {
        status[STATUS_UPPER_TESTS + i] = walked[STATUS_UPPER_TESTS + i];
        status[STATUS_LIST_BODY_PAIRS + i] = walked[STATUS_BODY_PAIRS + i];
        status[STATUS_CERTAIN + i] = state[STATE_CERTAIN + i];
        status[STATUS_OPEN + i] = state[STATE_OPEN + i];
    }
    status[STATUS_RUN] = state[STATE_RUN];
    if (!COUNT_WORK) return;
    counter_add_wide(status + STATUS_BVTT_NODES,
                     walked[STATUS_BVTT_NODES] | (ulong)walked[STATUS_BVTT_NODES + 1] << 32);
    counter_add_wide(status + STATUS_SEEDS, walked[STATUS_SEEDS] | (ulong)walked[STATUS_SEEDS + 1] << 32);
}

// Certain pairs that a team copies at once.
#define COPIED_AT_ONCE (8u * LANES)

// Answers with certain pairs, which are the first `count` of the answer.
DEVICE void emit_certain(GLOBAL const uint* certain, uint count, GLOBAL const uint* tiles,
                         const PairOutput* output, Tally* tally) {
    const uint step = GROUP_COUNT * LANE_TEAMS * COPIED_AT_ONCE;
    for (uint first = (GROUP_ID * LANE_TEAMS + LANE_TEAM) * COPIED_AT_ONCE; first < count;) {
        const uint end = count - first < COPIED_AT_ONCE ? count : first + COPIED_AT_ONCE;
        for (uint i = first + LANE_ID; i < end; i += (uint)LANE_STEP) {
            const WordPair pair = ((GLOBAL const WordPair*)certain)[i];
            if (OUTPUT != OUTPUT_PAIRS) {
                tally->count += 1;
                if (OUTPUT == OUTPUT_DIGEST)
                    tally_digest(tally, output->bodies, output->ids, items_of_slots(tiles, pair.x, pair.y));
            } else if (i < output->capacity) {
                if (PAIR_LAYOUT == PAIR_SLOTS)
                    ((GLOBAL WordPair*)output->found)[i] = pair;
                else
                    ((GLOBAL WordRow*)output->found)[i] = items_of_slots(tiles, pair.x, pair.y);
            }
        }
        if (count - first <= step) break;
        first += step;
    }
}

// Answers from the list, and saves the positions of the frame unless the list was kept. `vertex_rows` of
// `vertices` from `first_vertex` on are those of deformable bodies.
KERNEL void emit_list(GLOBAL const uint* certain, uint certain_capacity, GLOBAL const uint* open,
                      GLOBAL const uint* directions, uint open_capacity, GLOBAL const real* leaves,
                      GLOBAL const uint* tiles, GLOBAL const uint* bodies, GLOBAL const uint* ids,
                      GLOBAL uint* found, uint capacity, GLOBAL const real* poses, GLOBAL real* saved_poses,
                      uint pose_rows, GLOBAL const real* vertices, GLOBAL real* saved_vertices,
                      uint first_vertex, uint vertex_rows, GLOBAL const uint* state,
                      GLOBAL const uint* walked, GLOBAL uint* status) {
    TEAM_ARRAYS(1)
    const PairOutput output = {bodies, ids, 0, found, capacity, status};
    const uint run = state[STATE_RUN];
    Tally tally = empty_tally();
    if (run != FRAME_KEPT) {
        save(poses, saved_poses, pose_rows);
        save(vertices + 4 * (ulong)first_vertex, saved_vertices, vertex_rows);
    }
    copy_counts(state, walked, status);
    if (run != FRAME_DIRECT)
        emit_certain(certain, list_length(state, STATE_CERTAIN, certain_capacity), tiles, &output, &tally);
    const uint rows = run == FRAME_DIRECT ? 0u : list_length(state, STATE_OPEN, open_capacity);
    const ulong step = (ulong)GROUP_COUNT * LANE_TEAMS * LANES;
    ulong first = (ulong)(GROUP_ID * LANE_TEAMS + LANE_TEAM) * LANES;
    LANE_BARRIER;
    do { // runs at least once, as loops with barriers must
        FOR_LANES {
            const int is_row = first + lane < rows;
            const ulong i = is_row ? first + lane : 0;
            const WordPair pair = ((GLOBAL const WordPair*)open)[i];
            const int hits = is_row && overlaps_along(leaves, pair, directions[i]);
            if (COUNT_WORK) tally.tests += is_row ? 1 : 0;
            if (OUTPUT == OUTPUT_PAIRS) {
                const uint slot = reserve_slot(&team.found, hits);
                if (hits) team.pairs[slot] = pair;
            } else if (hits) {
                tally.count += 1;
                if (OUTPUT == OUTPUT_DIGEST)
                    tally_digest(&tally, bodies, ids, items_of_slots(tiles, pair.x, pair.y));
            }
        }
        LANE_BARRIER;
        const uint waiting = reserved_slots(&team.found);
        const int now = waiting >= PAIRS_FLUSHED;
        reserve(&team, waiting, now, status + STATUS_PAIRS);
        LANE_BARRIER;
        if (now) write_candidates(&team, waiting, tiles, found, capacity);
        if (now) begin_count(&team.found, 0u);
        LANE_BARRIER;
        first += step;
    } while (first < rows);
    const uint waiting = reserved_slots(&team.found);
    reserve(&team, waiting, 1, status + STATUS_PAIRS);
    LANE_BARRIER;
    if (OUTPUT == OUTPUT_PAIRS) write_candidates(&team, waiting, tiles, found, capacity);
    flush(&tally, status);
}
