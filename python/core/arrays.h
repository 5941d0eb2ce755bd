// SPDX-License-Identifier: MIT
// Arrays as they come from Python, of the host's memory, whose shape, type and order are checked before; and
// as they go there.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <nanobind/ndarray.h>
#include <utility>
#include <vector>

namespace tandem::python {

template<class Value, int columns>
using HostArray =
    nanobind::ndarray<const Value, nanobind::shape<-1, columns>, nanobind::c_contig, nanobind::device::cpu>;

using Points = HostArray<double, 3>;         ///< a vertex a row
using Corners = HostArray<std::uint32_t, 4>; ///< a tetrahedron a row
using Poses = HostArray<double, 7>;          ///< a body a row: tx ty tz qw qx qy qz

inline void copy_points(const Points& from, std::vector<Eigen::Vector3d>& to) {
    static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
    const auto* const first = reinterpret_cast<const Eigen::Vector3d*>(from.data());
    to.assign(first, first + from.shape(0));
}

/// A vector's values for Python, with its memory and what frees it.
template<class T>
std::pair<T*, nanobind::capsule> owned(std::vector<T> values) {
    auto* const kept = new std::vector<T>(std::move(values));
    return {kept->data(),
            nanobind::capsule(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); })};
}

/// Rows of NumPy's over the memory of `values`, each of which is a row or a number of one.
template<class Value, std::size_t columns, class T>
nanobind::ndarray<nanobind::numpy, Value, nanobind::shape<-1, columns>> owned_array(std::vector<T> values) {
    const auto rows = values.size() * sizeof(T) / (columns * sizeof(Value));
    const auto [data, owner] = owned(std::move(values));
    return {data, {rows, columns}, owner};
}

} // namespace tandem::python
