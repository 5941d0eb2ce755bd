// SPDX-License-Identifier: MIT
// Frames that lie in the device's memory, in double or float, as pack.cpp packs those of the host: operation
// by operation, so that the bits are the same. Rows out of range are counted, and packed as if they were at
// the origin: what comes after them in the frame has finite numbers, and the host refuses the frame.
#include "backends/portable.h"
#include "algorithms/answer/status.clh"
#include "algorithms/bodies/body.clh"

#if defined(__OPENCL_C_VERSION__) && PRECISION == 32
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif

// How the numbers of rows are written.
#define ROWS_FLOAT 0u
#define ROWS_DOUBLE 1u
#define ROWS_NONE 2u

#define POSE_NUMBERS 7
#define LEAST_NORM 1e-300 // of a quaternion, squared: normalising it is clear of overflow and of 0 / 0
#define LARGEST_NORM 1e300

DEVICE double number_at(GLOBAL const void* rows, uint kind, ulong i) {
    return kind == ROWS_DOUBLE ? ((GLOBAL const double*)rows)[i] : (double)((GLOBAL const float*)rows)[i];
}

// False also of what is no number.
DEVICE int in_range(const double* point, double limit) {
    return ABSOLUTE(point[0]) <= limit && ABSOLUTE(point[1]) <= limit && ABSOLUTE(point[2]) <= limit;
}

DEVICE RealRow row_of(double x, double y, double z, double w) {
    RealRow row;
    row.x = (real)x;
    row.y = (real)y;
    row.z = (real)z;
    row.w = (real)w;
    return row;
}

// The rows of a unit quaternion's matrix, as pose_rows of pack.cpp makes them.
DEVICE void write_pose(GLOBAL RealRow* rows, double w, double x, double y, double z, const double* t) {
    rows[0] = row_of(1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), t[0]);
    rows[1] = row_of(2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), t[1]);
    rows[2] = row_of(2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), t[2]);
}

// `numbers`: tx ty tz qw qx qy qz. Normalised as pose_of_row does it, and once more as pose_rows does: the
// second time changes bits, and they are part of the answer.
DEVICE void pack_pose(GLOBAL RealRow* rows, const double* numbers, double norm) {
    const double first = SQUARE_ROOT(norm);
    const double a = numbers[3] / first;
    const double b = numbers[4] / first;
    const double c = numbers[5] / first;
    const double d = numbers[6] / first;
    const double second = SQUARE_ROOT((a * a + b * b) + (c * c + d * d));
    write_pose(rows, a / second, b / second, c / second, d / second, numbers);
}

// A body a work-item. Bodies whose vertices are in the world are at the identity.
KERNEL void pack_poses(GLOBAL real* poses, GLOBAL const void* rows, uint kind, GLOBAL const uint* bodies,
                       uint count, double limit, double origin_x, double origin_y, double origin_z,
                       GLOBAL uint* status) {
    for (ulong body = GLOBAL_ID; body < count; body += GLOBAL_COUNT) {
        const int in_world = (bodies[body * BODY_WORDS + BODY_FLAGS] & BODY_IN_WORLD) != 0u;
        double numbers[POSE_NUMBERS] = {0, 0, 0, 1, 0, 0, 0};
        if (!in_world && kind != ROWS_NONE)
            for (uint i = 0; i < POSE_NUMBERS; ++i)
                numbers[i] = number_at(rows, kind, body * POSE_NUMBERS + i);
        double norm = (numbers[4] * numbers[4] + numbers[6] * numbers[6])
                      + (numbers[5] * numbers[5] + numbers[3] * numbers[3]);
        if (!(in_range(numbers, limit) && norm > LEAST_NORM && norm < LARGEST_NORM)) {
            counter_add(status + STATUS_FLAWED, 1u);
            for (uint i = 0; i < POSE_NUMBERS; ++i) numbers[i] = i == 3u ? 1 : 0;
            norm = 1;
        }
        if (!in_world) {
            numbers[0] -= origin_x;
            numbers[1] -= origin_y;
            numbers[2] -= origin_z;
        }
        pack_pose((GLOBAL RealRow*)(poses + body * POSE_REALS), numbers, norm);
    }
}

// A vertex a work-item: of one deformable body, whose rows begin with `first`. `places`: from `places_first`
// on, the row of each vertex among them, or NO_PLACE where it is in no tetrahedron.
#define NO_PLACE 0xffffffffu

KERNEL void pack_vertices(GLOBAL real* vertices, uint first, GLOBAL const uint* places, uint places_first,
                          GLOBAL const void* rows, uint kind, uint count, double limit, double origin_x,
                          double origin_y, double origin_z, GLOBAL uint* status) {
    for (ulong vertex = GLOBAL_ID; vertex < count; vertex += GLOBAL_COUNT) {
        double point[3];
        for (uint i = 0; i < 3u; ++i) point[i] = number_at(rows, kind, vertex * 3 + i);
        if (!in_range(point, limit)) {
            counter_add(status + STATUS_FLAWED, 1u);
            point[0] = point[1] = point[2] = 0;
        }
        const uint place = places[places_first + vertex];
        if (place != NO_PLACE)
            ((GLOBAL RealRow*)vertices)[(ulong)first + place] =
                row_of(point[0] - origin_x, point[1] - origin_y, point[2] - origin_z, 0);
    }
}
