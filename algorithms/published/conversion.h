// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"

#include <functional>
#include <optional>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace tandem {

/// Memory that is not zeroed before it is written: one thread would touch every page first.
template<class T>
struct Unwritten : std::allocator<T> {
    template<class U>
    struct rebind {
        using other = Unwritten<U>;
    };
    template<class U>
    void construct(U* at) {
        ::new (static_cast<void*>(at)) U;
    }
    template<class U, class... Given>
    void construct(U* at, Given&&... given) {
        ::new (static_cast<void*>(at)) U(std::forward<Given>(given)...);
    }
};

/// A frame's bodies as the device's arrays, one after the other.
struct Converted {
    template<class T>
    using Array = std::vector<T, Unwritten<T>>;

    Array<std::byte> vertices; ///< 4 reals each
    std::vector<std::byte> poses;
    Array<std::byte> nodes;             ///< K reals each, which hold nothing yet
    Array<std::uint32_t> tetrahedra;    ///< 4 vertices each
    Array<std::uint32_t> vertex_bodies; ///< of each vertex
    Array<std::uint8_t> boundary;       ///< of each tetrahedron
    bool rigid = false;                 ///< some body is: there is a transform
};

/// What the paper's code does on the host with every frame's bodies (tvcg18.md 1.2): on one thread, or, as
/// its OpenMP did ("a simple OpenMP acceleration of the conversion", abstract), a body or a block of bytes at
/// a time on several. The arrays have the same bytes.
class Converter {
public:
    /// `bodies` share nothing and must outlive this. `threads` of parallel: 0: one for each core.
    Converter(const Bodies& bodies, Conversion conversion, std::uint32_t threads);

    /// `node_bytes`: of the hierarchy's nodes.
    Converted convert(const Frame& frame, std::size_t node_bytes);
    Converted::Array<std::byte> copy(const Converted::Array<std::byte>& bytes);

private:
    /// Calls with parts 0..count - 1, on several threads where it may.
    void each(std::size_t count, const std::function<void(std::size_t)>& part);
    void convert_body(const Frame& frame, std::uint32_t body, Converted& converted) const;
    template<class Real>
    void empty_nodes(Converted::Array<std::byte>& nodes, std::size_t bytes);

    const Bodies& bodies_;
    std::optional<tbb::global_control> more_; ///< threads than cores
    std::optional<tbb::task_arena> arena_;    ///< of parallel
};

} // namespace tandem
