// SPDX-License-Identifier: MIT
// Definitions that host-compiled kernels need outside their namespaces; included once before them.
#pragma once

#include "backends/device.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>
#ifdef __SSE2__
#include <immintrin.h>
#endif

using uchar = unsigned char;
using uint = unsigned int;
using ulong = unsigned long;

namespace tandem::host {

// Functions in this file are always inlined: a copy compiled for newer processors must not serve all others
// (tests/levels.sh).

/// The work-group that a thread runs, and whether other threads run groups of the same launch.
inline constinit thread_local uint group_id = 0;
inline constinit thread_local uint group_count = 1;
inline constinit thread_local bool in_parallel = false;

/// Adds to memory that all work-groups share.
[[gnu::always_inline]] inline uint fetch_add(uint* pointer, uint value) {
    if (in_parallel) return __atomic_fetch_add(pointer, value, __ATOMIC_RELAXED);
    return std::exchange(*pointer, *pointer + value);
}

/// Adds to a work-group's own memory.
[[gnu::always_inline]] inline uint fetch_add_locally(uint* pointer, uint value) {
    return std::exchange(*pointer, *pointer + value);
}

/// The rounding error of a sum, exact in the same type (Knuth's exact sum, Muller et al. 2018, 4.3). Its sign
/// gives the direction of the exact sum, so that add_down and add_up need only operations that round to
/// nearest.
template<class Real>
[[gnu::always_inline]] inline Real rounded_off(Real a, Real b, Real sum) {
    const Real of_b = sum - a;
    const Real of_a = sum - of_b;
    return (a - of_a) + (b - of_b);
}

template<class Real>
[[gnu::always_inline]] inline Real add_down(Real a, Real b) {
    const Real sum = a + b;
    return rounded_off(a, b, sum) < 0 ? std::nextafter(sum, -std::numeric_limits<Real>::infinity()) : sum;
}

template<class Real>
[[gnu::always_inline]] inline Real add_up(Real a, Real b) {
    const Real sum = a + b;
    return rounded_off(a, b, sum) > 0 ? std::nextafter(sum, std::numeric_limits<Real>::infinity()) : sum;
}

// Operations on a number, or on each element of a pack of them (a vector of the compiler).

template<class Real>
using BitsOf = std::conditional_t<sizeof(Real) == 4, uint, ulong>;

[[gnu::always_inline]] inline uint bits_of(float value) { return std::bit_cast<uint>(value); }
[[gnu::always_inline]] inline ulong bits_of(double value) { return std::bit_cast<ulong>(value); }
[[gnu::always_inline]] inline float real_of(uint bits) { return std::bit_cast<float>(bits); }
[[gnu::always_inline]] inline double real_of(ulong bits) { return std::bit_cast<double>(bits); }
[[gnu::always_inline]] inline float absolute(float value) { return __builtin_fabsf(value); }
[[gnu::always_inline]] inline double absolute(double value) { return __builtin_fabs(value); }
[[gnu::always_inline]] inline float square_root(float value) { return __builtin_sqrtf(value); }
[[gnu::always_inline]] inline double square_root(double value) { return __builtin_sqrt(value); }

template<class Pack>
using ElementOf = std::remove_cvref_t<decltype(std::declval<Pack&>()[0])>;

template<class Pack, class Element = ElementOf<Pack>>
[[gnu::always_inline]] inline auto bits_of(Pack pack) {
    typedef BitsOf<Element> Bits __attribute__((vector_size(sizeof(Pack))));
    return (Bits)pack;
}

template<class Pack, class Element = ElementOf<Pack>>
[[gnu::always_inline]] inline auto real_of(Pack bits) {
    typedef std::conditional_t<sizeof(Element) == 4, float, double> Reals
        __attribute__((vector_size(sizeof(Pack))));
    return (Reals)bits;
}

template<class Pack, class Element = ElementOf<Pack>>
[[gnu::always_inline]] inline Pack absolute(Pack pack) {
    return real_of(bits_of(pack) & (~BitsOf<Element>{0} >> 1));
}

// The compiler has no vector code of its own for these two.

template<class Pack, class Element = ElementOf<Pack>>
[[gnu::always_inline]] inline Pack square_root(Pack pack) {
#ifdef __SSE2__
    if constexpr (sizeof(Pack) == 16 && sizeof(Element) == 4) return (Pack)_mm_sqrt_ps((__m128)pack);
    if constexpr (sizeof(Pack) == 16 && sizeof(Element) == 8) return (Pack)_mm_sqrt_pd((__m128d)pack);
#endif
#ifdef __AVX__
    if constexpr (sizeof(Pack) == 32 && sizeof(Element) == 4) return (Pack)_mm256_sqrt_ps((__m256)pack);
    if constexpr (sizeof(Pack) == 32 && sizeof(Element) == 8) return (Pack)_mm256_sqrt_pd((__m256d)pack);
#endif
#ifdef __AVX512F__
    if constexpr (sizeof(Pack) == 64 && sizeof(Element) == 4) return (Pack)_mm512_sqrt_ps((__m512)pack);
    if constexpr (sizeof(Pack) == 64 && sizeof(Element) == 8) return (Pack)_mm512_sqrt_pd((__m512d)pack);
#endif
    for (std::size_t i = 0; i < sizeof(Pack) / sizeof(Element); ++i) pack[i] = square_root(Element{pack[i]});
    return pack;
}

template<class Pack>
[[gnu::always_inline]] inline bool any_of_pack(Pack flags) {
#ifdef __SSE2__
    if constexpr (sizeof(Pack) == 16) return _mm_movemask_epi8((__m128i)flags) != 0;
#endif
#ifdef __AVX__
    if constexpr (sizeof(Pack) == 32) return _mm256_testz_si256((__m256i)flags, (__m256i)flags) == 0;
#endif
#ifdef __AVX512F__
    if constexpr (sizeof(Pack) == 64) return _mm512_test_epi32_mask((__m512i)flags, (__m512i)flags) != 0;
#endif
    bool any = false;
    for (std::size_t i = 0; i < sizeof(Pack) / sizeof(flags[0]); ++i) any |= flags[i] != 0;
    return any;
}

/// Place `number` of a pack of half the first column, then half the second, of the rows in two packs.
constexpr int of_two_columns(int number, int size, int column) {
    const int half = size / 2;
    return 4 * (number % half) + column + number / half;
}

template<int column, class Pack, std::size_t... I>
[[gnu::always_inline]] inline Pack two_columns(Pack a, Pack b, std::index_sequence<I...>) {
    return __builtin_shufflevector(a, b, of_two_columns(I, sizeof...(I), column)...);
}

template<int half, class Pack, std::size_t... I>
[[gnu::always_inline]] inline Pack halves(Pack a, Pack b, std::index_sequence<I...>) {
    constexpr int size = sizeof...(I);
    return __builtin_shufflevector(a, b,
                                   (half * size / 2 + static_cast<int>(I) % (size / 2)
                                    + (static_cast<int>(I) < size / 2 ? 0 : size))...);
}

/// The first three columns of as many rows of four as a pack has elements.
template<class Row, class Pack>
[[gnu::always_inline]] inline void take_rows(const Row* rows, Pack& x, Pack& y, Pack& z) {
    constexpr auto all = std::make_index_sequence<sizeof(Pack) / sizeof(x[0])>();
    Pack part[4];
    __builtin_memcpy(part, rows, sizeof(part));
    const Pack first = two_columns<0>(part[0], part[1], all), second = two_columns<0>(part[2], part[3], all);
    x = halves<0>(first, second, all);
    y = halves<1>(first, second, all);
    z = halves<0>(two_columns<2>(part[0], part[1], all), two_columns<2>(part[2], part[3], all), all);
}

template<class Pack>
[[gnu::always_inline]] inline uint count_of_pack(Pack flags) {
    uint count = 0;
    if (!any_of_pack(flags)) return count;
    for (std::size_t i = 0; i < sizeof(Pack) / sizeof(flags[0]); ++i) count += flags[i] != 0 ? 1u : 0u;
    return count;
}

template<class Pack>
[[gnu::always_inline]] inline Pack numbers_of_pack() {
    Pack numbers{};
    for (std::size_t i = 0; i < sizeof(Pack) / sizeof(numbers[0]); ++i) numbers[i] = i;
    return numbers;
}

struct HostBuffer : Buffer::Impl {
    void* native() const override { return data; }
    std::unique_ptr<std::byte[]> storage;
    std::byte* data = nullptr;
};

/// A define that the host reads at run time instead of compiling one variant per value.
struct RuntimeDefine {
    const char* name;
    void (*set)(long value); ///< for the later kernels of the calling thread
    long initial;            ///< the kernel's default
};

/// One kernel of one variant. `defines` are the compiled ones, "AXES=0;K=18;PRECISION=32".
struct HostKernel {
    const char* source;
    const char* entry;
    const char* defines;
    void (*run)(std::span<const Argument>);
    std::size_t argument_count;
    std::span<const RuntimeDefine> runtime;
    int level; ///< of its instructions: x86-64-v2, -v3 or -v4; 0: any processor
};

/// Kernels of the project by variant (generated).
std::span<const std::span<const HostKernel>> host_kernels();

/// Adds variants of a program's own kernels; cmake/kernels.cmake generates the call. They must live as long
/// as the program. Not thread-safe.
void add_host_kernels(std::span<const std::span<const HostKernel>> variants);

template<class T>
T argument_as(const Argument& argument) {
    if constexpr (std::is_pointer_v<T>) {
        // The project writes both the kernel's parameters and the launch's arguments, so a mismatch is no
        // user error and nothing is thrown.
        return reinterpret_cast<T>(
            static_cast<HostBuffer*>(*std::get_if<Buffer::Impl*>(&argument.value()))->data);
    } else {
        T value{};
        std::memcpy(&value, std::get_if<Argument::Scalar>(&argument.value())->bytes.data(), sizeof(T));
        return value;
    }
}

template<auto Function>
struct Invoke;

template<class... Parameters, void (*Function)(Parameters...)>
struct Invoke<Function> {
    static constexpr std::size_t count = sizeof...(Parameters);

    static void run(std::span<const Argument> arguments) {
        [&]<std::size_t... I>(std::index_sequence<I...>) {
            Function(argument_as<Parameters>(arguments[I])...);
        }
        (std::index_sequence_for<Parameters...>{});
    }
};

} // namespace tandem::host
