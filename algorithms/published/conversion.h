// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"

#include <functional>
#include <optional>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace tandem {

/// Allocator that does not zero memory, because one thread would touch every page first.
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

/// A frame's bodies as the device's arrays.
struct Converted {
    template<class T>
    using Array = std::vector<T, Unwritten<T>>;

    Array<std::byte> vertices; ///< 4 reals each
    std::vector<std::byte> poses;
    Array<std::byte> nodes;             ///< K reals each; empty before the refit
    Array<std::uint32_t> tetrahedra;    ///< 4 vertices each
    Array<std::uint32_t> vertex_bodies; ///< by vertex
    Array<std::uint8_t> boundary;       ///< by tetrahedron
    bool rigid = false;                 ///< whether some body is rigid and needs a transform
};

/// Conversion of every frame's bodies on the host, as in the paper's code. It runs on one thread or, as with
/// its OpenMP ("a simple OpenMP acceleration of the conversion", abstract), on several. Each thread then
/// converts one body or block of bytes at a time. The arrays have the same bytes either way.
class Converter {
public:
    /// `bodies` must not share data and must outlive this object. `threads`: for parallel conversion; 0: one
    /// per core.
    Converter(const Bodies& bodies, Conversion conversion, std::uint32_t threads);

    /// `node_bytes`: size of the hierarchy's nodes.
    Converted convert(const Frame& frame, std::size_t node_bytes);
    /// Calls `part` with 0..count - 1, on several threads if the conversion is parallel.
    void each(std::size_t count, const std::function<void(std::size_t)>& part);

private:
    void convert_body(const Frame& frame, std::uint32_t body, Converted& converted) const;
    template<class Real>
    void empty_nodes(Converted::Array<std::byte>& nodes, std::size_t bytes);

    const Bodies& bodies_;
    std::optional<tbb::global_control> more_; ///< allows more threads than cores
    std::optional<tbb::task_arena> arena_;    ///< for parallel conversion
};

} // namespace tandem
