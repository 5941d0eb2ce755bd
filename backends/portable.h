// SPDX-License-Identifier: MIT
// The kernel dialect: one text for OpenCL C, CUDA and host C++. Rules: every group size, also 1, gives
// correct results. Barriers stand only in uniform control flow. Only scalars and pointers cross the host
// boundary. Shared counters are read with ATOMIC_READ. No group waits for another. Parameters are defines
// with a default, written as #ifndef NAME / #define NAME value / #endif, so that a file compiles alone.
#ifndef TANDEM_PORTABLE_H
#define TANDEM_PORTABLE_H

#include "backends/lanes.h"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif
#ifndef PRECISION
#define PRECISION 32
#endif

// A team is a part of a work-group that waits for its own work-items only: a warp. When the compiler has no
// barrier for a warp, the whole group waits, so that every dialect has the same teams.
#if GROUP_SIZE % 32 == 0
#define TEAM_SIZE 32
#else
#define TEAM_SIZE GROUP_SIZE
#endif
#define TEAM_COUNT (GROUP_SIZE / TEAM_SIZE)
#define TEAM_ID (LOCAL_ID / TEAM_SIZE)
#define TEAM_LANE (LOCAL_ID % TEAM_SIZE)
#if TEAM_SIZE == GROUP_SIZE
#define TEAM_BARRIER BARRIER
#elif defined(__CUDACC__)
#define TEAM_BARRIER __syncwarp()
#elif defined(__NV_CL_C_VERSION)
#define TEAM_BARRIER asm volatile("bar.warp.sync 0xffffffff;" ::: "memory")
#else
#define TEAM_BARRIER BARRIER
#endif

// Lanes are the elements of a tile (lanes.h). A team of LANE_STEP work-items works on a tile; each runs the
// body of FOR_LANES for every LANE_STEP-th lane. On a GPU a lane is a work-item of a warp. On the host
// device, whose groups have one work-item, FOR_LANES is a loop that the compiler vectorises. Without a
// barrier for a warp the group is the team, and work-items past the last lane only wait. A value kept from
// one FOR_LANES to the next is an array `type name[LANE_PARTS]`; a lane uses name[part]. No barriers inside
// FOR_LANES.
#define LANES TANDEM_LANES
#if GROUP_SIZE % LANES == 0 && (GROUP_SIZE == LANES || defined(__CUDACC__) || defined(__NV_CL_C_VERSION))
#define LANE_STEP LANES
#define LANE_BARRIER TEAM_BARRIER
#define FOR_LANES for (uint part = 0, lane = LANE_ID; part < 1u && lane < (uint)LANES; ++part)
#else
#define LANE_STEP GROUP_SIZE
#define LANE_BARRIER BARRIER
#define FOR_LANES for (uint part = 0, lane = LANE_ID; lane < (uint)LANES; ++part, lane += (uint)LANE_STEP)
#endif
#define LANE_PARTS ((LANES + LANE_STEP - 1) / LANE_STEP)
#define LANE_TEAMS (GROUP_SIZE / LANE_STEP)
#define LANE_TEAM (LOCAL_ID / LANE_STEP)
#define LANE_ID (LOCAL_ID % LANE_STEP) // of a work-item in its team
// When the lanes are a warp, these exchange values without memory. LANES_THAT gives one bit per lane.
#if LANE_STEP == LANES && defined(__CUDACC__)
#define LANES_ARE_WARP 1
#define LANES_THAT(condition) __ballot_sync(0xffffffffu, (condition))
#define FROM_FIRST_LANE(value) __shfl_sync(0xffffffffu, (value), 0)
#define FROM_LAST_LANE(value) __shfl_sync(0xffffffffu, (value), 31)
#define FROM_LANE_BEFORE(value, distance) __shfl_up_sync(0xffffffffu, (value), (distance))
#elif LANE_STEP == LANES && defined(__NV_CL_C_VERSION)
#define LANES_ARE_WARP 1
#define LANES_THAT(condition) lanes_that(condition)
#define FROM_FIRST_LANE(value) from_lane((value), 0u)
#define FROM_LAST_LANE(value) from_lane((value), 31u)
#define FROM_LANE_BEFORE(value, distance) from_lane_before((value), (distance))
#else
#define LANES_ARE_WARP 0
#endif

#if defined(__OPENCL_C_VERSION__)
#pragma OPENCL FP_CONTRACT OFF
#if PRECISION == 64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif
#define KERNEL __kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
#define GLOBAL __global
#define LOCAL __local
#define LOCAL_ARRAY(type, name, count) __local type name[count]
#define DEVICE static inline
#define OUT_OF_LINE DEVICE // see the host's
#if GROUP_SIZE == 1        // nothing to wait for, and PoCL 3.1 aborts on some barriers in loops at this size
#define BARRIER
#define BARRIER_GLOBAL
#else
#define BARRIER barrier(CLK_LOCAL_MEM_FENCE)
#define BARRIER_GLOBAL barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)
#endif
#define LOCAL_ID ((uint)get_local_id(0))
#define GROUP_ID ((uint)get_group_id(0))
#define GROUP_COUNT ((uint)get_num_groups(0))
#define ATOMIC_ADD(pointer, value) atomic_add((pointer), (value))
#define ATOMIC_READ(pointer) atomic_or((pointer), 0u)
// Replaces a word that has the expected value; returns the value before.
#define ATOMIC_REPLACE(pointer, expected, value) atomic_cmpxchg((pointer), (expected), (value))
#define LOCAL_ATOMIC_ADD(pointer, value) atomic_add((pointer), (value))
#define COUNT_LEADING_ZEROS(value) ((uint)clz((uint)(value)))
#define COUNT_ONES(value) ((uint)popcount((uint)(value)))
#define SQUARE_ROOT(value) sqrt(value)
#define ABSOLUTE(value) fabs(value)
#ifdef __NV_CL_C_VERSION // one instruction on NVIDIA; elsewhere handling of NaN costs more
#define MINIMUM(a, b) fmin((a), (b))
#define MAXIMUM(a, b) fmax((a), (b))
#else
#define MINIMUM(a, b) ((a) < (b) ? (a) : (b))
#define MAXIMUM(a, b) ((a) > (b) ? (a) : (b))
#endif
#define UNROLL _Pragma("unroll")
#define NO_UNROLL _Pragma("unroll 1")
#define LOAD_AGAIN ((void)0)
#define REAL_INFINITY ((real)INFINITY)

#elif defined(__CUDACC__)
// A source that defines KERNEL_REGISTERS before it includes this file asks for that many groups at once as
// have room for so many registers a work-item.
#ifdef KERNEL_REGISTERS
#define GROUPS_IN_REGISTERS (65536 / ((KERNEL_REGISTERS)*GROUP_SIZE))
#define KERNEL                                                                                               \
    extern "C" __global__ __launch_bounds__(                                                                 \
        GROUP_SIZE, GROUPS_IN_REGISTERS<1 ? 1 : GROUPS_IN_REGISTERS> 16 ? 16 : GROUPS_IN_REGISTERS)
#else
#define KERNEL extern "C" __global__ __launch_bounds__(GROUP_SIZE)
#endif
#define GLOBAL
#define LOCAL
#define LOCAL_ARRAY(type, name, count) __shared__ type name[count]
#define DEVICE static __device__ __forceinline__
#define OUT_OF_LINE DEVICE
#define BARRIER __syncthreads()
#define BARRIER_GLOBAL __syncthreads()
#define LOCAL_ID ((uint)threadIdx.x)
#define GROUP_ID ((uint)blockIdx.x)
#define GROUP_COUNT ((uint)gridDim.x)
#define ATOMIC_ADD(pointer, value) atomicAdd((pointer), (value))
#define ATOMIC_READ(pointer) atomicOr((pointer), 0u)
#define ATOMIC_REPLACE(pointer, expected, value) atomicCAS((pointer), (expected), (value))
#define LOCAL_ATOMIC_ADD(pointer, value) atomicAdd((pointer), (value))
#define COUNT_LEADING_ZEROS(value) ((uint)__clz((int)(value)))
#define COUNT_ONES(value) ((uint)__popc((uint)(value)))
#define SQUARE_ROOT(value) sqrt(value)
#define ABSOLUTE(value) fabs(value)
#define MINIMUM(a, b) fmin((a), (b))
#define MAXIMUM(a, b) fmax((a), (b))
#if PRECISION == 64 // sums rounded down and up; OpenCL C has none
#define ADD_DOWN(a, b) __dadd_rd((a), (b))
#define ADD_UP(a, b) __dadd_ru((a), (b))
#else
#define ADD_DOWN(a, b) __fadd_rd((a), (b))
#define ADD_UP(a, b) __fadd_ru((a), (b))
#endif
#define UNROLL _Pragma("unroll")
#define NO_UNROLL _Pragma("unroll 1")
// Ends the use of registers for values that are in memory: reads after it load them again. It waits for
// nothing and is no instruction.
#define LOAD_AGAIN asm volatile("" ::: "memory")
#define REAL_INFINITY ((real)__int_as_float(0x7f800000))
typedef unsigned char uchar;
typedef unsigned int uint;
typedef unsigned long ulong; // 64 bits on Linux

#else // host C++: groups of one work-item, see backends/host/dialect.h
#define KERNEL static
#define GLOBAL
#define LOCAL
#ifdef LOCAL_ON_STACK
#define LOCAL_ARRAY(type, name, count) type name[count]
#else
#define LOCAL_ARRAY(type, name, count)                                                                       \
    static thread_local std::vector<type> name##_storage;                                                    \
    name##_storage.resize(count);                                                                            \
    type* const name = name##_storage.data()
#endif
// A call would pass values of packs through memory and end the vector code of a loop over lanes, and g++
// inlines only a part of what a file with many kernels calls.
#if defined(IN_PACKS) || defined(__AVX2__)
#define DEVICE [[gnu::always_inline]] static inline
#else
#define DEVICE static inline
#endif
// Long text for few pairs, which would cost registers of the text around it: the host has one kernel for all
// contact rules.
#define OUT_OF_LINE [[gnu::noinline]] static
#define BARRIER ((void)0)
#define BARRIER_GLOBAL ((void)0)
#define LOCAL_ID 0u
#define GROUP_ID (tandem::host::group_id)
#define GROUP_COUNT (tandem::host::group_count)
#define ATOMIC_ADD(pointer, value) tandem::host::fetch_add((pointer), (value))
#define ATOMIC_READ(pointer) __atomic_load_n((pointer), __ATOMIC_RELAXED)
#define ATOMIC_REPLACE(pointer, expected, value) tandem::host::replace((pointer), (expected), (value))
#define LOCAL_ATOMIC_ADD(pointer, value) tandem::host::fetch_add_locally((pointer), (value))
#define COUNT_LEADING_ZEROS(value) ((uint)__builtin_clz((uint)(value)))
#define COUNT_ONES(value) ((uint)__builtin_popcount((uint)(value)))
#define SQUARE_ROOT(value) tandem::host::square_root(value)
#define ABSOLUTE(value) tandem::host::absolute(value)
#define MINIMUM(a, b) ((a) < (b) ? (a) : (b))
#define MAXIMUM(a, b) ((a) > (b) ? (a) : (b))
#define ADD_DOWN(a, b) tandem::host::add_down((a), (b))
#define ADD_UP(a, b) tandem::host::add_up((a), (b))
#define UNROLL
#define NO_UNROLL
#define LOAD_AGAIN ((void)0)
#define REAL_INFINITY std::numeric_limits<real>::infinity()
#endif

#define ALIGNED(bytes) __attribute__((aligned(bytes)))

#if PRECISION == 64
typedef double real;
#else
typedef float real;
#endif

// Conversion of a real to its bits and back: sign, exponent, mantissa.
#if PRECISION == 64
#define EXPONENT_AT 52
#define LARGEST_EXPONENT 2046
#else
#define EXPONENT_AT 23
#define LARGEST_EXPONENT 254
#endif
#if defined(__OPENCL_C_VERSION__) && PRECISION == 64
#define BITS_OF(value) as_ulong(value)
#define REAL_OF(bits) as_double(bits)
#elif defined(__OPENCL_C_VERSION__)
#define BITS_OF(value) as_uint(value)
#define REAL_OF(bits) as_float(bits)
#elif defined(__CUDACC__) && PRECISION == 64
#define BITS_OF(value) ((ulong)__double_as_longlong(value))
#define REAL_OF(bits) __longlong_as_double((long long)(bits))
#elif defined(__CUDACC__)
#define BITS_OF(value) __float_as_uint(value)
#define REAL_OF(bits) __uint_as_float(bits)
#else
#define BITS_OF(value) tandem::host::bits_of(value)
#define REAL_OF(bits) tandem::host::real_of(bits)
#endif

#include "backends/packs.h"

#define GLOBAL_ID (GROUP_ID * (uint)(GROUP_SIZE) + LOCAL_ID)
#define GLOBAL_COUNT (GROUP_COUNT * (uint)(GROUP_SIZE))

// A 64-bit counter as two 32-bit words {low, high}: 64-bit atomics are an extension in OpenCL 1.2. Returns
// the low word before the addition. Beyond 2^32 the low word wraps around, and high != 0 shows it.
DEVICE uint counter_add(GLOBAL uint* counter, uint value) {
    const uint before = ATOMIC_ADD(counter, value);
    if (before + value < before) ATOMIC_ADD(counter + 1, 1u);
    return before;
}

// Adds a 64-bit value with wrap-around. The sum is valid once all additions are done.
DEVICE void counter_add_wide(GLOBAL uint* counter, ulong value) {
    const uint low = (uint)value;
    const uint before = ATOMIC_ADD(counter, low);
    const uint high = (uint)(value >> 32) + (before + low < before ? 1u : 0u);
    if (high != 0u) ATOMIC_ADD(counter + 1, high);
}

#if LANES_ARE_WARP && defined(__NV_CL_C_VERSION)
DEVICE uint lanes_that(int condition) {
    uint all;
    asm volatile("{ .reg .pred p; setp.ne.s32 p, %1, 0; vote.sync.ballot.b32 %0, p, 0xffffffff; }"
                 : "=r"(all)
                 : "r"(condition));
    return all;
}

DEVICE uint from_lane(uint value, uint lane) {
    uint other;
    asm volatile("shfl.sync.idx.b32 %0, %1, %2, 31, 0xffffffff;" : "=r"(other) : "r"(value), "r"(lane));
    return other;
}

DEVICE uint from_lane_before(uint value, uint distance) {
    uint before;
    asm volatile("shfl.sync.up.b32 %0, %1, %2, 0, 0xffffffff;" : "=r"(before) : "r"(value), "r"(distance));
    return before;
}
#endif

// A counter of a team of lanes; all of the team take part in each call. In a warp every work-item holds the
// value; elsewhere it is a word of local memory.
typedef struct {
    LOCAL uint* word;
    uint value;
} LaneCounter;

// Sets the counter to `value`. A LANE_BARRIER must separate this call from the last read before it, and
// another from the next reserved slot after it.
DEVICE void begin_count(LaneCounter* counter, uint value) {
    if (LANES_ARE_WARP)
        counter->value = value;
    else if (LANE_ID == 0u)
        *counter->word = value;
}

// Reserves a slot for each lane with `needs_slot`.
DEVICE uint reserve_slot(LaneCounter* counter, int needs_slot) {
#if LANES_ARE_WARP
    const uint all = LANES_THAT(needs_slot);
    const uint slot = counter->value + COUNT_ONES(all & ((1u << LANE_ID) - 1u));
    counter->value += COUNT_ONES(all);
    return slot;
#else
    return needs_slot ? LOCAL_ATOMIC_ADD(counter->word, 1u) : 0u;
#endif
}

// Reserves `count` slots for each lane; returns the first.
DEVICE uint reserve_slots(LaneCounter* counter, uint count) {
#if LANES_ARE_WARP
    uint sum = count; // of this lane and those before it
    UNROLL for (uint distance = 1; distance < (uint)LANES; distance *= 2u) {
        const uint before = FROM_LANE_BEFORE(sum, distance);
        if (LANE_ID >= distance) sum += before;
    }
    const uint slot = counter->value + sum - count;
    counter->value += FROM_LAST_LANE(sum);
    return slot;
#else
    return count != 0u ? LOCAL_ATOMIC_ADD(counter->word, count) : 0u;
#endif
}

// Adds the sum of the lanes' values; on a warp these are 0 or 1.
DEVICE void add_lanes(LaneCounter* counter, uint value) {
#if LANES_ARE_WARP
    counter->value += COUNT_ONES(LANES_THAT(value != 0u));
#else
    if (value != 0u) LOCAL_ATOMIC_ADD(counter->word, value);
#endif
}

// The number of reserved slots; call it after a LANE_BARRIER.
DEVICE uint reserved_slots(const LaneCounter* counter) {
    return LANES_ARE_WARP ? counter->value : *counter->word;
}

// Adds the number of reserved slots to a counter in device memory; returns what that was before. Call it
// after a LANE_BARRIER. On other devices than a warp it uses the word, so that begin_count must follow.
DEVICE uint place_of_slots(const LaneCounter* counter, GLOBAL uint* length) {
    const uint count = reserved_slots(counter);
#if LANES_ARE_WARP
    uint place = 0;
    if (LANE_ID == 0u && count != 0u) place = counter_add(length, count);
    return FROM_FIRST_LANE(place);
#else
    LANE_BARRIER;
    if (LANE_ID == 0u && count != 0u) *counter->word = counter_add(length, count);
    LANE_BARRIER;
    return *counter->word;
#endif
}

#endif
