// SPDX-License-Identifier: MIT
// Packs frames in the device's memory, in double or float, and poses of frames in the host's, with the
// operations of pack.cpp, so that the bits are the same. Rows out of range are counted and packed as if they
// were at the origin, so that later kernels get finite numbers. The host then rejects the frame.
// Host variants: PRECISION
#include "backends/portable.h"
#include "algorithms/kernels/status.clh"
#include "algorithms/bodies/body.clh"

#if defined(__OPENCL_C_VERSION__) && PRECISION == 32
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif

// Number format of rows.
#define ROWS_FLOAT 0u
#define ROWS_DOUBLE 1u
#define ROWS_NONE 2u

#define POSE_NUMBERS 7
#define LARGEST_NUMBER 1.7976931348623157e308
// As in base/quaternion.cpp: the powers of two 498, -498, 600 and -600.
#define LARGE_QUATERNION 8.183476519740355e+149
#define SMALL_QUATERNION 1.221974545399842e-150
#define SCALE_UP 4.149515568880993e+180
#define SCALE_DOWN 2.409919865102884e-181

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

// The 12 numbers of a unit quaternion and a translation, as pose_rows of pack.cpp.
DEVICE void pose_rows(const double* q, const double* t, double* rows) {
    const double w = q[0];
    const double x = q[1];
    const double y = q[2];
    const double z = q[3];
    rows[0] = 1 - 2 * (y * y + z * z);
    rows[1] = 2 * (x * y - z * w);
    rows[2] = 2 * (x * z + y * w);
    rows[3] = t[0];
    rows[4] = 2 * (x * y + z * w);
    rows[5] = 1 - 2 * (x * x + z * z);
    rows[6] = 2 * (y * z - x * w);
    rows[7] = t[1];
    rows[8] = 2 * (x * z - y * w);
    rows[9] = 2 * (y * z + x * w);
    rows[10] = 1 - 2 * (x * x + y * y);
    rows[11] = t[2];
}

// Moves the translation to the image of a mesh's shift, as shifted() of shift.cpp.
DEVICE void shift_pose(GLOBAL const double* shift, double* rows) {
    const double x = shift[0];
    const double y = shift[1];
    const double z = shift[2];
    if (x == 0 && y == 0 && z == 0) return;
    for (uint i = 0; i < 12u; i += 4u)
        rows[i + 3] = ((rows[i] * x + rows[i + 1] * y) + rows[i + 2] * z) + rows[i + 3];
}

DEVICE void write_pose(GLOBAL RealRow* poses, const double* rows) {
    for (uint i = 0; i < 3u; ++i)
        poses[i] = row_of(rows[4 * i], rows[4 * i + 1], rows[4 * i + 2], rows[4 * i + 3]);
}

// Loads a row tx ty tz qw qx qy qz. Bodies with vertices in world coordinates get the identity.
DEVICE void load_pose(GLOBAL const void* rows, uint kind, GLOBAL const uint* bodies, ulong body,
                      double* numbers) {
    const int in_world = (bodies[body * BODY_WORDS + BODY_FLAGS] & BODY_IN_WORLD) != 0u;
    for (uint i = 0; i < POSE_NUMBERS; ++i)
        numbers[i] = in_world || kind == ROWS_NONE ? (i == 3u ? 1 : 0)
                                                   : number_at(rows, kind, body * POSE_NUMBERS + i);
}

DEVICE double largest_of(const double* q) {
    double largest = 0;
    for (uint i = 0; i < 4u; ++i) largest = ABSOLUTE(q[i]) > largest ? ABSOLUTE(q[i]) : largest;
    return largest;
}

// As unit() of base/quaternion.cpp, before the division.
DEVICE double scaled_length(double* q) {
    const double largest = largest_of(q);
    const double scale = largest > LARGE_QUATERNION ? SCALE_DOWN : largest < SMALL_QUATERNION ? SCALE_UP : 1;
    for (uint i = 0; i < 4u; ++i) q[i] *= scale;
    return SQUARE_ROOT((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]));
}

// Normalises as pose_of_row and again as pose_rows, because the second time changes bits that affect answers.
DEVICE void unit_quaternion(const double* numbers, double* q) {
    for (uint i = 0; i < 4u; ++i) q[i] = numbers[3 + i];
    for (uint time = 0; time < 2u; ++time) {
        const double length = scaled_length(q);
        for (uint i = 0; i < 4u; ++i) q[i] /= length;
    }
}

// Whether the quaternion of a row is finite and not 0.
DEVICE int is_rotation(const double* numbers) {
    int is_finite = 1;
    for (uint i = 3; i < POSE_NUMBERS; ++i) is_finite = is_finite && ABSOLUTE(numbers[i]) <= LARGEST_NUMBER;
    return is_finite && largest_of(numbers + 3) > 0;
}

// A work-item packs one body. `shifts`: three numbers a body; not read unless `has_shifts`.
KERNEL void pack_poses(GLOBAL real* poses, GLOBAL const void* rows, uint kind, GLOBAL const uint* bodies,
                       uint count, double limit, double origin_x, double origin_y, double origin_z,
                       GLOBAL const double* shifts, uint has_shifts, GLOBAL uint* status) {
    for (ulong body = GLOBAL_ID; body < count; body += GLOBAL_COUNT) {
        const int in_world = (bodies[body * BODY_WORDS + BODY_FLAGS] & BODY_IN_WORLD) != 0u;
        double numbers[POSE_NUMBERS];
        load_pose(rows, kind, bodies, body, numbers);
        if (!(in_range(numbers, limit) && is_rotation(numbers))) {
            counter_add(status + STATUS_FLAWED, 1u);
            for (uint i = 0; i < POSE_NUMBERS; ++i) numbers[i] = i == 3u ? 1 : 0;
        }
        if (!in_world) {
            numbers[0] -= origin_x;
            numbers[1] -= origin_y;
            numbers[2] -= origin_z;
        }
        double q[4];
        unit_quaternion(numbers, q);
        double pose[12];
        pose_rows(q, numbers, pose);
        if (has_shifts != 0u && !in_world) shift_pose(shifts + 3 * body, pose);
        write_pose((GLOBAL RealRow*)(poses + body * POSE_REALS), pose);
    }
}

// Bound on the square root of a difference of two normalised quaternions, and factor for all later roundings:
// see arc.cpp, whose operations these are.
#define NORMALISATION_ERROR 8.881784197001252e-16 // 2^-50
#define ARC_SLACK (1 + 9.5367431640625e-07)       // 1 + 2^-20

DEVICE double arc_between(const double* p, const double* q) {
    const double dot = (p[0] * q[0] + p[1] * q[1]) + (p[2] * q[2] + p[3] * q[3]);
    const double sign = dot < 0 ? -1 : 1;
    const double w = q[0] - sign * p[0];
    const double x = q[1] - sign * p[1];
    const double y = q[2] - sign * p[2];
    const double z = q[3] - sign * p[3];
    const double square = (w * w + x * x) + (y * y + z * z);
    if (!(square > 0)) return 0;
    const double distance = SQUARE_ROOT(square) + NORMALISATION_ERROR;
    return 0.5 * distance * distance * ARC_SLACK;
}

// With MOTION_LINEAR: the last row of both poses of a body, after pack_poses has packed both. It counts no
// flaws, because pack_poses has.
KERNEL void pack_arcs(GLOBAL real* poses, GLOBAL real* next_poses, GLOBAL const void* rows, uint kind,
                      GLOBAL const void* next_rows, uint next_kind, GLOBAL const uint* bodies, uint count) {
    for (ulong body = GLOBAL_ID; body < count; body += GLOBAL_COUNT) {
        double numbers[POSE_NUMBERS];
        double next_numbers[POSE_NUMBERS];
        load_pose(rows, kind, bodies, body, numbers);
        load_pose(next_rows, next_kind, bodies, body, next_numbers);
        double arc = 0;
        if (is_rotation(numbers) && is_rotation(next_numbers)) {
            double p[4];
            double q[4];
            unit_quaternion(numbers, p);
            unit_quaternion(next_numbers, q);
            arc = arc_between(p, q);
        }
        const RealRow row = row_of(0, 0, 0, arc);
        ((GLOBAL RealRow*)(poses + body * POSE_REALS))[3] = row;
        ((GLOBAL RealRow*)(next_poses + body * POSE_REALS))[3] = row;
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
        const double q[4] = {w / length, x / length, y / length, z / length};
        double pose[12];
        pose_rows(q, t, pose);
        write_pose((GLOBAL RealRow*)(poses + body * POSE_REALS), pose);
    }
}

// A work-item packs one vertex of one deformable body, whose rows begin with `first`. `indices`: from
// `indices_first` on, the row of each vertex relative to `first`, or NO_INDEX if no tetrahedron uses it.
// `pressures`: one for each of `indices`; not read unless `has_pressures`.
#define NO_INDEX 0xffffffffu

KERNEL void pack_vertices(GLOBAL real* vertices, uint first, GLOBAL const uint* indices, uint indices_first,
                          GLOBAL const void* rows, uint kind, uint count, double limit, double origin_x,
                          double origin_y, double origin_z, GLOBAL const real* pressures, uint has_pressures,
                          GLOBAL uint* status) {
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
                row_of(point[0] - origin_x, point[1] - origin_y, point[2] - origin_z,
                       has_pressures != 0u ? pressures[indices_first + vertex] : (real)0);
    }
}
