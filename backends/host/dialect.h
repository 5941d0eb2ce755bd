// SPDX-License-Identifier: MIT
// Definitions that host-compiled kernels need outside their namespaces; included once before them.
#pragma once

#include "backends/device.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

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
