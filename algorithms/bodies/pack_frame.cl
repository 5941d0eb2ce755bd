// SPDX-License-Identifier: MIT
// Packs frames in the device's memory, in double or float, and poses of frames in the host's, with the
// operations of pack.cpp, so that the bits are the same. Rows out of range are counted and packed as if they
// were at the origin, so that later kernels get finite numbers. The host then rejects the frame.
#include "backends/portable.h"
#include "algorithms/answer/status.clh"
#include "algorithms/bodies/body.clh"

#if defined(__OPENCL_C_VERSION__) && PRECISION == 32
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif

// Number format of rows.
#define ROWS_FLOAT 0u
#define ROWS_DOUBLE 1u
#define ROWS_NONE 2u

#define POSE_NUMBERS 7
#define LEAST_NORM 1e-300 // squared norm of a quaternion: the bounds exclude overflow and 0 / 0
#define LARGEST_NORM 1e300

DEVICE double number_at(GLOBAL const void* rows, uint kind, ulong i) {
    return kind == ROWS_DOUBLE ? ((GLOBAL const double*)rows)[i] : (double)((GLOBAL const float*)rows)[i];
}

// False also for NaN.
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

// The rows of a unit quaternion's matrix, as in pose_rows of pack.cpp.
DEVICE void write_pose(GLOBAL RealRow* rows, double w, double x, double y, double z, const double* t) {
    rows[0] = row_of(1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), t[0]);
    rows[1] = row_of(2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), t[1]);
    rows[2] = row_of(2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), t[2]);
}

// `numbers`: tx ty tz qw qx qy qz. Normalises as pose_of_row and again as pose_rows, because the second time
// changes bits that affect answers.
DEVICE void pack_pose(GLOBAL RealRow* rows, const double* numbers, double norm) {
    const double first = SQUARE_ROOT(norm);
    const double a = numbers[3] / first;
    const double b = numbers[4] / first;
    const double c = numbers[5] / first;
    const double d = numbers[6] / first;
    const double second = SQUARE_ROOT((a * a + b * b) + (c * c + d * d));
    write_pose(rows, a / second, b / second, c / second, d / second, numbers);
}

// A work-item packs one body. Bodies with vertices in world coordinates get the identity.
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

// A work-item packs one body of a frame in the host's memory: double rows, normalised once as in pose_rows.
KERNEL void pack_unit_poses(GLOBAL real* poses, GLOBAL const double* rows, uint count) {
    for (ulong body = GLOBAL_ID; body < count; body += GLOBAL_COUNT) {
        GLOBAL const double* numbers = rows + body * POSE_NUMBERS;
        const double t[3] = {numbers[0], numbers[1], numbers[2]};
        const double w = numbers[3];
        const double x = numbers[4];
        const double y = numbers[5];
        const double z = numbers[6];
        const double length = SQUARE_ROOT((w * w + x * x) + (y * y + z * z));
        write_pose((GLOBAL RealRow*)(poses + body * POSE_REALS), w / length, x / length, y / length,
                   z / length, t);
    }
}

// A work-item packs one vertex of one deformable body, whose rows begin with `first`. `indices`: from
// `indices_first` on, the row of each vertex relative to `first`, or NO_INDEX if no tetrahedron uses it.
#define NO_INDEX 0xffffffffu

KERNEL void pack_vertices(GLOBAL real* vertices, uint first, GLOBAL const uint* indices, uint indices_first,
                          GLOBAL const void* rows, uint kind, uint count, double limit, double origin_x,
                          double origin_y, double origin_z, GLOBAL uint* status) {
    for (ulong vertex = GLOBAL_ID; vertex < count; vertex += GLOBAL_COUNT) {
        double point[3];
        for (uint i = 0; i < 3u; ++i) point[i] = number_at(rows, kind, vertex * 3 + i);
        if (!in_range(point, limit)) {
            counter_add(status + STATUS_FLAWED, 1u);
            point[0] = point[1] = point[2] = 0;
        }
        const uint index = indices[indices_first + vertex];
        if (index != NO_INDEX)
            ((GLOBAL RealRow*)vertices)[(ulong)first + index] =
                row_of(point[0] - origin_x, point[1] - origin_y, point[2] - origin_z, 0);
    }
}
