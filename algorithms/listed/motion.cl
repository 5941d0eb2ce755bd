// SPDX-License-Identifier: MIT
// Decides in every frame whether the list is still valid, and makes the bounds from which a new one is made.
#define WHOLE_LEAVES
#include "backends/portable.h"
#include "algorithms/hierarchy/tiles.clh"
#include "algorithms/listed/motion.clh"

#ifndef OUTPUT
#define OUTPUT 0
#endif

// Marks the pads that are too small for the motion of some body since the saved frame. Work-items over rigid
// bodies and vertices of deformable ones; each marks the number of pads above its largest motion.
KERNEL void measure_motion(GLOBAL const real* shapes, uint bodies, GLOBAL const real* poses,
                           GLOBAL const real* saved_poses, GLOBAL const real* vertices,
                           GLOBAL const real* saved_vertices, uint first_vertex, uint vertex_count,
                           GLOBAL const real* pads, GLOBAL uint* state) {
    real most = 0;
    for (uint body = GLOBAL_ID; body < bodies; body += GLOBAL_COUNT) {
        GLOBAL const real* shape = shapes + (ulong)body * (4 * SHAPE_ROWS);
        if (shape[4] < 0) continue;
        const Pose now = pose_at(poses, body);
        const Pose then = pose_at(saved_poses, body);
        const real motion = motion_of_body(shape, &now, &then);
        most = MAXIMUM(motion, most);
    }
    for (uint i = GLOBAL_ID; i < vertex_count; i += GLOBAL_COUNT) {
        const RealRow now = ((GLOBAL const RealRow*)vertices)[(ulong)first_vertex + i];
        const real motion = motion_of_vertex(now, ((GLOBAL const RealRow*)saved_vertices)[i]);
        most = MAXIMUM(motion, most); // vertices that are not numbers are of skipped tetrahedra
    }
    state[STATE_MARKS + pads_above(pads, most)] = 1u;
}

// The pad with which a list lasts about FRAMES_WANTED frames of the motion `since` in `frames` frames. PADS:
// it would last too short to pay.
#define FRAMES_WANTED 12
#define FRAMES_PAYING 3
DEVICE uint wanted_pad(GLOBAL const real* pads, real since, uint frames) {
    const real each = since / (real)frames;
    if (each * FRAMES_PAYING > pads[0]) return PADS;
    uint pad = 0;
    while (pad + 1u < PADS && each * FRAMES_WANTED <= pads[pad + 1u]) ++pad;
    return pad;
}

// How a new frame is walked. `above`: pads above the largest motion since the saved frame.
DEVICE void decide_frame(GLOBAL const real* pads, uint above, GLOBAL uint* state) {
    const uint before = state[STATE_FRAME];
    const uint frames = state[STATE_FRAMES] + 1u;
    state[STATE_FRAMES] = frames;
    if ((before == FRAME_LIST || before == FRAME_KEPT) && above > state[STATE_PAD]) {
        state[STATE_FRAME] = FRAME_KEPT;
        return;
    }
    const uint pad = above == 0u ? PADS : wanted_pad(pads, pads[above - 1u], frames);
    state[STATE_FRAME] = pad == PADS ? FRAME_DIRECT : FRAME_LIST;
    state[STATE_PAD] = pad == PADS ? 0u : pad;
    state[STATE_FRAMES] = 0u;
}

// One work-group. `walked`: the status of the walk that makes the list, whose body pairs are `given` in the
// status of the frame, or counted by a later search.
KERNEL void decide_list(GLOBAL const real* pads, uint request, uint given, GLOBAL uint* state,
                        GLOBAL uint* walked, GLOBAL uint* status) {
    for (uint i = LOCAL_ID; i < STATUS_WORDS; i += (uint)GROUP_SIZE) walked[i] = 0u;
    BARRIER_GLOBAL;
    if (LOCAL_ID != 0u) return;
    uint above = 0;
    while (above < PADS && state[STATE_MARKS + above] == 0u) ++above;
    for (uint i = 0; i <= PADS; ++i) state[STATE_MARKS + i] = 0u;
    if (request == REQUEST_DECIDE) decide_frame(pads, above, state);
    if (request == REQUEST_DIRECT) {
        state[STATE_FRAME] = FRAME_DIRECT;
        state[STATE_FRAMES] = 0u;
    }
    const uint frame = state[STATE_FRAME];
    const uint run = request == REQUEST_EMIT && frame == FRAME_LIST ? FRAME_KEPT : frame;
    state[STATE_RUN] = run;
    if (run == FRAME_LIST)
        state[STATE_CERTAIN] = state[STATE_CERTAIN + 1] = state[STATE_OPEN] = state[STATE_OPEN + 1] = 0u;
    walked[STATUS_WINDOW_FIRST] = status[STATUS_WINDOW_FIRST];
    walked[STATUS_WINDOW_END] = status[STATUS_WINDOW_END];
    if (given != 0u && run != FRAME_KEPT) {
        walked[STATUS_BODY_PAIRS] = status[STATUS_BODY_PAIRS];
        walked[STATUS_BODY_PAIRS + 1] = status[STATUS_BODY_PAIRS + 1];
    }
    if (OUTPUT == OUTPUT_PAIRS && run == FRAME_KEPT) { // certain pairs are the first of the answer
        status[STATUS_PAIRS] = state[STATE_CERTAIN];
        status[STATUS_PAIRS + 1] = state[STATE_CERTAIN + 1];
    }
    status[STATUS_REBUILDS] = frame == FRAME_KEPT ? 0u : 1u;
}

// The bounds of tiles and bodies for the walk of this run, enlarged by the pad of the list. While the list is
// kept, bodies have no volume, so that the search finds no body pairs and the walk has nothing to do.
KERNEL void pad_bounds(GLOBAL const real* volumes, uint bodies, GLOBAL const real* roots, uint tiles,
                       GLOBAL const real* uppers, uint upper_tiles, GLOBAL const real* pads,
                       GLOBAL const uint* state, GLOBAL real* padded_volumes, GLOBAL real* padded_roots,
                       GLOBAL real* padded_uppers) {
    const uint run = state[STATE_RUN];
    const real pad = pad_of(state, pads);
    for (ulong i = GLOBAL_ID; i < (ulong)bodies * K; i += GLOBAL_COUNT) {
        const uint word = (uint)(i % K);
        const int is_upper = word >= (uint)DIRECTIONS;
        const real by = movement(pad, word % (uint)DIRECTIONS);
        padded_volumes[i] = run == FRAME_KEPT     ? (is_upper ? -REAL_INFINITY : REAL_INFINITY)
                            : run == FRAME_DIRECT ? volumes[i]
                                                  : moved_out(volumes[i], by, is_upper);
    }
    if (run == FRAME_KEPT) return;
    for (ulong i = GLOBAL_ID; i < (ulong)tiles * K; i += GLOBAL_COUNT) {
        const uint word = (uint)(i % K);
        const real by = movement(pad, word % (uint)DIRECTIONS);
        padded_roots[i] = run == FRAME_DIRECT ? roots[i] : moved_out(roots[i], by, word >= (uint)DIRECTIONS);
    }
    for (ulong i = GLOBAL_ID; i < (ulong)upper_tiles * (K * LANES); i += GLOBAL_COUNT) {
        const uint word = (uint)(i / LANES % K);
        const real by = movement(pad, word % (uint)DIRECTIONS);
        padded_uppers[i] =
            run == FRAME_DIRECT ? uppers[i] : moved_out(uppers[i], by, word >= (uint)DIRECTIONS);
    }
}
