// SPDX-License-Identifier: MIT
// output=wrenches: the polygons of each body pair are added up to the force on body a, the torque about its
// pose, and the area. A sum is a fixed-point number of 64 and 32 bits, so that the order of additions does
// not matter. Units are powers of two for each body pair, from the sizes and pressures of the two meshes.
// Host variants: PRECISION
#include "backends/portable.h"
#include "algorithms/answer/body_pair_table.clh"
#include "algorithms/bodies/body.clh"

#define WRENCH_PARTS 7 // force, torque, area
// Words of a body pair's sums: for each part whole numbers and 2^-32ths, 64 bits each; then the number of
// polygons.
#define SUM_WORDS (4 * WRENCH_PARTS + 2)

// A part's unit has this many whole numbers, so that a polygon may have 2^8 units.
#define PER_UNIT ((real)8388608.0)              // 2^23
#define MOST_WHOLE ((real)2147483648.0)         // 2^31: fewer than 2^32 of them are within 64 bits
#define PER_WHOLE ((real)4294967296.0)          // 2^32
#define WHOLE_OF ((real)1.1920928955078125e-07) // 2^-23

typedef struct {
    long whole[WRENCH_PARTS], rest[WRENCH_PARTS];
    ulong polygons;
    uint place; // in the table, or NO_PLACE
} WrenchSum;

#define NO_PLACE 0xffffffffu

// What a body adds to a frame's wrenches: `pivot`, about which torques are, in the coordinates of its
// vertices, and powers of two: `size`, at least its extent, `reach`, at least the distance of its points from
// the pivot, and `pressure`, at least half of its largest.
typedef struct {
    Point pivot;
    real size, reach, pressure;
} BodyArm;

DEVICE BodyArm arm_of(GLOBAL const real* arms, uint body) {
    GLOBAL const RealRow* rows = (GLOBAL const RealRow*)arms + 2 * (ulong)body;
    BodyArm arm;
    arm.pivot.x = rows[0].x;
    arm.pivot.y = rows[0].y;
    arm.pivot.z = rows[0].z;
    arm.size = rows[0].w;
    arm.reach = rows[1].x;
    arm.pressure = rows[1].y;
    return arm;
}

// The units of a body pair.
typedef struct {
    real area, pressure, reach;
} WrenchUnits;

DEVICE WrenchUnits units_of(const BodyArm* a, const BodyArm* b) {
    const real size = a->size < b->size ? a->size : b->size;
    WrenchUnits units;
    units.area = size * size;
    units.pressure = a->pressure < b->pressure ? a->pressure : b->pressure;
    units.reach = a->reach;
    return units;
}

// Adds a number in units; returns whether it is small enough.
DEVICE int add_number(WrenchSum* sum, int part, real number) {
    const real scaled = number * PER_UNIT;
    if (!(ABSOLUTE(scaled) < MOST_WHOLE)) return 0;
    const long whole = (long)scaled;
    const real rest = (scaled - (real)whole) * PER_WHOLE;
    sum->whole[part] += whole;
    sum->rest[part] += (long)(rest + (rest < (real)0 ? (real)-0.5 : (real)0.5));
    return 1;
}

// Adds a polygon's row of two rows of reals: centroid, normal, area, pressure.
DEVICE int add_polygon(WrenchSum* sum, RealRow first, RealRow second, Point pivot, const WrenchUnits* units) {
    const real amount = (second.z / units->area) * (second.w / units->pressure);
    const real x = first.w * amount;
    const real y = second.x * amount;
    const real z = second.y * amount;
    const real arm_x = (first.x - pivot.x) / units->reach;
    const real arm_y = (first.y - pivot.y) / units->reach;
    const real arm_z = (first.z - pivot.z) / units->reach;
    int fits = add_number(sum, 0, x);
    fits &= add_number(sum, 1, y);
    fits &= add_number(sum, 2, z);
    fits &= add_number(sum, 3, arm_y * z - arm_z * y);
    fits &= add_number(sum, 4, arm_z * x - arm_x * z);
    fits &= add_number(sum, 5, arm_x * y - arm_y * x);
    fits &= add_number(sum, 6, second.z / units->area);
    sum->polygons += 1u;
    return fits;
}

DEVICE void clear_sum(WrenchSum* sum) {
    UNROLL for (int i = 0; i < WRENCH_PARTS; ++i) sum->whole[i] = sum->rest[i] = 0;
    sum->polygons = 0;
    sum->place = NO_PLACE;
}

DEVICE void put_sum(const WrenchSum* sum, GLOBAL uint* sums) {
    if (sum->place == NO_PLACE) return;
    GLOBAL uint* to = sums + (ulong)sum->place * SUM_WORDS;
    UNROLL for (int i = 0; i < WRENCH_PARTS; ++i) {
        counter_add_wide(to + 4 * i, (ulong)sum->whole[i]);
        counter_add_wide(to + 4 * i + 2, (ulong)sum->rest[i]);
    }
    counter_add_wide(to + 4 * WRENCH_PARTS, sum->polygons);
}

DEVICE void local_add_wide(LOCAL uint* counter, ulong value) {
    const uint low = (uint)value;
    const uint before = LOCAL_ATOMIC_ADD(counter, low);
    const uint high = (uint)(value >> 32) + (before + low < before ? 1u : 0u);
    if (high != 0u) LOCAL_ATOMIC_ADD(counter + 1, high);
}

// Adds the sums of a group: together those of the first work-item's body pair, because a scene may have few.
// The whole group must call it.
DEVICE void put_group(const WrenchSum* sum, LOCAL uint* words, GLOBAL uint* sums) {
    LOCAL uint* common = words + SUM_WORDS; // the place
    for (uint i = LOCAL_ID; i < SUM_WORDS; i += GROUP_SIZE) words[i] = 0u;
    if (LOCAL_ID == 0u) *common = sum->place;
    BARRIER;
    const uint place = *common;
    if (sum->place == place && place != NO_PLACE) {
        UNROLL for (int i = 0; i < WRENCH_PARTS; ++i) {
            local_add_wide(words + 4 * i, (ulong)sum->whole[i]);
            local_add_wide(words + 4 * i + 2, (ulong)sum->rest[i]);
        }
        local_add_wide(words + 4 * WRENCH_PARTS, sum->polygons);
    } else {
        put_sum(sum, sums);
    }
    BARRIER;
    if (place == NO_PLACE) return;
    for (uint i = 2u * LOCAL_ID; i < SUM_WORDS; i += 2u * GROUP_SIZE)
        counter_add_wide(sums + (ulong)place * SUM_WORDS + i, (ulong)words[i + 1] << 32 | words[i]);
}

// Continues with the sum of a body pair.
DEVICE void begin_sum(WrenchSum* sum, uint place, GLOBAL uint* sums) {
    if (place == sum->place) return;
    put_sum(sum, sums);
    clear_sum(sum);
    sum->place = place;
}

// Adds the polygon of a contact; returns whether its numbers are small enough.
DEVICE int add_row(WrenchSum* sum, const ContactTable* all, ulong contact, GLOBAL const real* poses,
                   GLOBAL const real* arms) {
    const PairMembers pair = members_of_contact(all, contact);
    const BodyArm a = arm_of(arms, pair.a.body);
    const BodyArm b = arm_of(arms, pair.b.body);
    const WrenchUnits units = units_of(&a, &b);
    const Pose pose = pose_at(poses, pair.a.body);
    const RealRow pivot = {a.pivot.x, a.pivot.y, a.pivot.z, 0};
    GLOBAL const RealRow* row = (GLOBAL const RealRow*)all->contact_values + 2 * contact;
    return add_polygon(sum, row[0], row[1], placed(&pose, (pair.a.flags & BODY_IN_WORLD) != 0u, pivot),
                       &units);
}

// `arms`: arm_of() of each body. `sums`: SUM_WORDS for each place of the table, 0 before. The rows of a group
// lie together, because polygons of a body pair do.
KERNEL void add_wrenches(GLOBAL const uint* found, GLOBAL const uint* owners, GLOBAL const uint* ids,
                         GLOBAL const uint* contact_ids, GLOBAL const real* contact_values, uint capacity,
                         GLOBAL const real* poses, GLOBAL const real* arms, GLOBAL uint* table, uint places,
                         GLOBAL uint* sums, GLOBAL uint* status) {
    LOCAL_ARRAY(uint, words, SUM_WORDS + 1);
    LOCAL_ARRAY(GroupContact, best, GROUP_SIZE);
    const ContactTable all = {found, owners, ids, contact_ids, contact_values};
    const ulong rows = contacts_fit(status, capacity) ? status[STATUS_CONTACTS] : 0u;
    const ulong share = (rows + GROUP_COUNT - 1u) / GROUP_COUNT;
    const ulong end = (GROUP_ID + 1u) * share < rows ? (GROUP_ID + 1u) * share : rows;
    WrenchSum sum;
    clear_sum(&sum);
    ulong first = GROUP_ID * share;
    do { // at least once, as loops with barriers must: see refit.cl
        const uint count = first < end ? of_group(end - first) : 0u;
        const uint place = place_in_group(&all, first, count, table, places, best);
        if (LOCAL_ID < count && place == places) status[STATUS_EXCEEDED + EXCEEDED_TABLE] = 1u;
        if (place != places) {
            begin_sum(&sum, place, sums);
            if (!add_row(&sum, &all, first + LOCAL_ID, poses, arms))
                status[STATUS_EXCEEDED + EXCEEDED_UNITS] = 1u;
        }
        BARRIER; // the next contacts replace these
        first += GROUP_SIZE;
    } while (first < end);
    put_group(&sum, words, sums);
}

// The value of a part, in units.
DEVICE real number_at(GLOBAL const uint* words) {
    ulong whole = (ulong)words[1] << 32 | words[0];
    ulong rest = (ulong)words[3] << 32 | words[2];
    whole += (ulong)((long)rest >> 32); // an arithmetic shift in every dialect
    rest &= (ulong)0xffffffff;
    const int is_negative = (long)whole < 0;
    if (is_negative) { // its magnitude, so that nothing cancels
        whole = ~whole + (rest == 0 ? 1u : 0u);
        rest = rest == 0 ? 0 : (ulong)0x100000000 - rest;
    }
    const real magnitude = ((real)whole + (real)rest / PER_WHOLE) * WHOLE_OF;
    return is_negative ? -magnitude : magnitude + (real)0;
}

// Writes a row for each body pair in the table: the pair of its contact there, the number of polygons, and
// force, torque, area, 0. Writes nothing if some contacts did not fit. A sum that is not finite exceeds the
// units.
KERNEL void write_wrenches(GLOBAL const uint* found, GLOBAL const uint* owners,
                           GLOBAL const uint* contact_ids, uint capacity, GLOBAL const real* arms,
                           GLOBAL const uint* table, uint places, GLOBAL const uint* sums,
                           GLOBAL uint* kept_ids, GLOBAL real* kept_values, GLOBAL uint* status) {
    if (!contacts_fit(status, capacity)) return;
    for (ulong place = GLOBAL_ID; place < places; place += GLOBAL_COUNT) {
        if (table[place] == 0u) continue;
        const uint number = contact_ids[(ulong)(table[place] - 1u) * CONTACT_WORDS];
        const PairMembers pair = members_of(found, number, owners);
        const BodyArm a = arm_of(arms, pair.a.body);
        const BodyArm b = arm_of(arms, pair.b.body);
        const WrenchUnits units = units_of(&a, &b);
        GLOBAL const uint* words = sums + place * SUM_WORDS;
        const ulong row = counter_add(status + STATUS_REDUCED, 1u);
        kept_ids[row * CONTACT_WORDS] = number;
        kept_ids[row * CONTACT_WORDS + 1] = words[4 * WRENCH_PARTS];
        GLOBAL real* to = kept_values + row * CONTACT_REALS;
        for (int i = 0; i < WRENCH_PARTS; ++i) {
            real value = number_at(words + 4 * i) * units.area;
            if (i < 6) value = value * units.pressure;
            if (i >= 3 && i < 6) value = value * units.reach;
            if (!(value - value == (real)0)) status[STATUS_EXCEEDED + EXCEEDED_UNITS] = 1u;
            to[i] = value + (real)0;
        }
        to[7] = 0;
    }
}
