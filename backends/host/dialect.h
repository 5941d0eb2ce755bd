// SPDX-License-Identifier: MIT
// Definitions that host-compiled kernels need outside their namespaces; included once before them.
#pragma once

#include "backends/device.h"
#include "backends/host/counters.h"

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

/// The columns of as many rows of four as a pack has elements.
template<class Row, class Pack>
[[gnu::always_inline]] inline void take_rows(const Row* rows, Pack& x, Pack& y, Pack& z, Pack& w) {
    constexpr auto all = std::make_index_sequence<sizeof(Pack) / sizeof(x[0])>();
    Pack part[4];
    __builtin_memcpy(part, rows, sizeof(part));
    const Pack first = two_columns<0>(part[0], part[1], all), second = two_columns<0>(part[2], part[3], all);
    x = halves<0>(first, second, all);
    y = halves<1>(first, second, all);
    const Pack third = two_columns<2>(part[0], part[1], all), fourth = two_columns<2>(part[2], part[3], all);
    z = halves<0>(third, fourth, all);
    w = halves<1>(third, fourth, all);
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

// Boxes of 32 lanes: one row of their lower ends and one of their upper ends for each direction. With 8
// planes or more, g++ 12 makes no vector code of loops over the lanes.

#if defined(__AVX512F__)
constexpr std::size_t pack_bytes = 64, registers = 32;
#elif defined(__AVX2__)
constexpr std::size_t pack_bytes = 32, registers = 16;
#else
constexpr std::size_t pack_bytes = 16, registers = 16;
#endif

/// The ends of one box, and the gap beyond which it is apart from another: 0, or a published tolerance.
template<class Real>
struct Ends {
    const Real *lower, *upper;
    Real tolerance;
};

/// Boxes of as many lanes as a vector register has elements.
template<std::size_t words, class Real>
struct LaneBoxes {
    typedef Real Pack __attribute__((vector_size(pack_bytes)));
    using Flag = std::conditional_t<sizeof(Real) == 4, int, long>;
    typedef Flag Flags __attribute__((vector_size(pack_bytes)));
    static constexpr std::size_t size = pack_bytes / sizeof(Real), directions = words / 2;
    typedef uint Words __attribute__((vector_size(4 * size)));

    Pack ends[words];

    [[gnu::always_inline]] void load(const Real (*box)[32], std::size_t first) {
        for (std::size_t word = 0; word < words; ++word)
            __builtin_memcpy(&ends[word], box[word] + first, sizeof(Pack));
    }

    /// All bits set: apart from the box along one of the directions.
    [[gnu::always_inline]] Flags apart_from(const Ends<Real>& box) const {
        Flags apart{};
        if (box.tolerance == 0) {
            for (std::size_t d = 0; d < directions; ++d)
                apart |= (box.lower[d] > ends[directions + d]) | (ends[d] > box.upper[d]);
        } else {
            for (std::size_t d = 0; d < directions; ++d)
                apart |= (box.lower[d] - ends[directions + d] > box.tolerance)
                         | (ends[d] - box.upper[d] > box.tolerance);
        }
        return apart;
    }
};

/// Boxes as rows of `stride` reals, lower ends first, with a bit each.
template<class Real>
struct Rows {
    const Real* ends;
    std::size_t stride;
    const uint* bits;
    uint count;
};

/// The bits of the rows that each lane's box overlaps.
template<std::size_t words, class Real>
[[gnu::always_inline]] inline void find_hits(const Rows<Real>& rows, const Real (*box)[32], Real tolerance,
                                             uint (&hits)[32]) {
    using Boxes = LaneBoxes<words, Real>;
    constexpr std::size_t packs = 2 * words < registers ? 2 : 1; // at once, whose boxes stay in registers
    for (std::size_t first = 0; first < 32; first += packs * Boxes::size) {
        Boxes boxes[packs];
        typename Boxes::Flags found[packs]{};
        for (std::size_t i = 0; i < packs; ++i) boxes[i].load(box, first + i * Boxes::size);
        for (uint r = 0; r < rows.count; ++r) {
            const Real* row = rows.ends + r * rows.stride;
            for (std::size_t i = 0; i < packs; ++i)
                found[i] |= ~boxes[i].apart_from({row, row + words / 2, tolerance})
                            & static_cast<typename Boxes::Flag>(rows.bits[r]);
        }
        for (std::size_t i = 0; i < packs; ++i) {
            const auto of_lanes = __builtin_convertvector(found[i], typename Boxes::Words);
            __builtin_memcpy(hits + first + i * Boxes::size, &of_lanes, sizeof(of_lanes));
        }
    }
}

/// Clears the marks (1 or 0) of lanes whose boxes are apart from one box.
template<std::size_t words, class Real>
[[gnu::always_inline]] inline void leave_out_apart(const Ends<Real>& one, const Real (*box)[32],
                                                   uint (&keeps)[32]) {
    using Boxes = LaneBoxes<words, Real>;
    for (std::size_t first = 0; first < 32; first += Boxes::size) {
        Boxes boxes;
        boxes.load(box, first);
        typename Boxes::Words kept;
        __builtin_memcpy(&kept, keeps + first, sizeof(kept));
        kept &= __builtin_convertvector(boxes.apart_from(one) + 1, typename Boxes::Words);
        __builtin_memcpy(keeps + first, &kept, sizeof(kept));
    }
}

/// Bit i: value i of 32 is not 0.
[[gnu::always_inline]] inline uint nonzero_of(const uint (&values)[32]) {
#ifdef __AVX512F__
    const auto half = [&](int first) {
        const auto of_half = _mm512_loadu_si512(values + first);
        return uint{_mm512_test_epi32_mask(of_half, of_half)};
    };
    return half(0) | half(16) << 16;
#else
    uint bits = 0;
    for (uint i = 0; i < 32; ++i) bits |= (values[i] != 0 ? 1u : 0u) << i;
    return bits;
#endif
}

/// Numbers of a tile's row 0 and lane 0, and which of the two words of a pair is the row's.
struct PairWords {
    uint first_row, first_lane;
    bool row_first;
};

/// Stores a pair of a row and a lane for each bit of the lane's `rows`; returns their number. It stores up to
/// eight pairs more, because the number of bits is not foreseen.
template<class Pair>
[[gnu::always_inline]] inline uint put_pairs(Pair* to, uint rows, uint lane, const PairWords& words) {
    static_assert(sizeof(Pair) == 8);
    const uint lane_number = words.first_lane + lane;
    const auto count = static_cast<uint>(std::popcount(rows));
#ifdef __AVX512F__
    const auto counted = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const auto lane_word = _mm512_set1_epi64(static_cast<long long>(
        words.row_first ? std::uint64_t{lane_number} << 32 : std::uint64_t{lane_number}));
    const auto shift = _mm_cvtsi32_si128(words.row_first ? 0 : 32);
    const auto store = [&](Pair* at, __m256i eight) {
        const auto row_word = _mm512_sll_epi64(_mm512_cvtepu32_epi64(eight), shift);
        _mm512_storeu_si512(at, _mm512_or_si512(row_word, lane_word));
    };
    for (uint first = 0; first < 32; first += 16) {
        const auto of_half = static_cast<__mmask16>(rows >> first);
        const auto numbers =
            _mm512_add_epi32(counted, _mm512_set1_epi32(static_cast<int>(words.first_row + first)));
        const auto packed = _mm512_maskz_compress_epi32(of_half, numbers);
        store(to, _mm512_castsi512_si256(packed));
        const int of_row = std::popcount(static_cast<uint>(of_half));
        if (of_row > 8) store(to + 8, _mm512_extracti64x4_epi64(packed, 1));
        to += of_row;
    }
#else
    for (; rows != 0; rows &= rows - 1, ++to) {
        const uint row = words.first_row + static_cast<uint>(std::countr_zero(rows));
        *to = words.row_first ? Pair{row, lane_number} : Pair{lane_number, row};
    }
#endif
    return count;
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
    /// Other defines that are compiled, with their defaults: "MOTION=0;ROUNDING=1;".
    std::string_view constants = {};
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
