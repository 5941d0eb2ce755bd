// SPDX-License-Identifier: MIT
// Packs, a part of portable.h. In a kernel file that defines IN_PACKS, a work-item of the host device has
// PACK elements side by side in vector types of the compiler; on other devices, and in other files, it has
// one. What differs between the elements of a pack is of type reals, uints or flags. Such values are chosen
// by ?:, flags are combined by & | NOT, and the text branches on ANY and ALL only. Arithmetic with a scalar
// of the same type is allowed on either side.
#ifndef TANDEM_PACKS_H
#define TANDEM_PACKS_H

// The vector types of packs, as wide as the registers of the instructions that the file is compiled for.
#if defined(IN_PACKS) && !defined(__OPENCL_C_VERSION__) && !defined(__CUDACC__)
#if defined(__AVX512F__)
#define PACK_BYTES 64
#elif defined(__AVX2__)
#define PACK_BYTES 32
#else
#define PACK_BYTES 16
#endif
#define PACK (PACK_BYTES / (PRECISION / 8))
typedef real reals __attribute__((vector_size(PACK_BYTES)));
#if PRECISION == 64
typedef ulong uints __attribute__((vector_size(PACK_BYTES)));
typedef long flags __attribute__((vector_size(PACK_BYTES)));
#else
typedef uint uints __attribute__((vector_size(PACK_BYTES)));
typedef int flags __attribute__((vector_size(PACK_BYTES)));
#endif
#endif

#if defined(PACK)
#define SAME(value) (reals{} + (real)(value))      // a real for all elements
#define SAME_WORD(value) (uints{} + (uint)(value)) // a word for all elements
#define NEVER (flags{})
#define ALWAYS (~flags{})
#define NOT(condition) (~(condition))
#define BIT(condition) ((uints)(condition)&1u) // 1 or 0
#define ANY(condition) tandem::host::any_of_pack(condition)
#define ALL(condition) (!tandem::host::any_of_pack(~(condition)))
#define COUNT_FLAGS(condition) tandem::host::count_of_pack(condition)
#define AT(value, element) ((value)[element])
#define ELEMENT_NUMBERS tandem::host::numbers_of_pack<uints>() // 0, 1, 2, ...
typedef uints patterns;                                        // bits of reals
#define NO_PATTERN (patterns{})
#define SIGN_OF(pattern) ((pattern) >> (PRECISION - 1)) // 1 or 0
#else
#define PACK 1
typedef real reals;
typedef uint uints;
typedef int flags;
#define SAME(value) ((real)(value))
#define SAME_WORD(value) ((uint)(value))
#define NEVER 0
#define ALWAYS 1
#define NOT(condition) (!(condition))
#define BIT(condition) ((condition) ? 1u : 0u)
#define ANY(condition) (condition)
#define ALL(condition) (condition)
#define COUNT_FLAGS(condition) BIT(condition)
#define AT(value, element) (value)
#define ELEMENT_NUMBERS 0u
#if PRECISION == 64
typedef ulong patterns;
#else
typedef uint patterns;
#endif
#define NO_PATTERN ((patterns)0)
#define SIGN_OF(pattern) ((uint)((pattern) >> (PRECISION - 1)))
#endif
#define SIGN_BIT(value) SIGN_OF(BITS_OF(value))
#define FOR_PACK(element) for (uint element = 0; element < (uint)PACK; ++element)

// Counts in a group's memory, and runs the statement, which stores in place `entry`, if the condition holds.
// In packs it always stores, because branches are seldom foreseen; the place must exist.
#if PACK > 1
#define APPEND_IF(condition, counter, statement)                                                             \
    do {                                                                                                     \
        const uint entry = *(counter);                                                                       \
        (statement);                                                                                         \
        *(counter) = entry + ((condition) ? 1u : 0u);                                                        \
    } while (0)
#else
#define APPEND_IF(condition, counter, statement)                                                             \
    do {                                                                                                     \
        if (condition) {                                                                                     \
            const uint entry = LOCAL_ATOMIC_ADD((counter), 1u);                                              \
            (statement);                                                                                     \
            (void)entry;                                                                                     \
        }                                                                                                    \
    } while (0)
#endif

#endif
