// SPDX-License-Identifier: MIT
// Arrays from Python in host memory, whose shape, type and order are already checked, and arrays for Python.
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

using Points = HostArray<double, 3>; ///< one row per vertex
using Numbers =                      ///< one per vertex
    nanobind::ndarray<const double, nanobind::shape<-1>, nanobind::c_contig, nanobind::device::cpu>;
using Corners = HostArray<std::uint32_t, 4>; ///< one row per tetrahedron
using Poses = HostArray<double, 7>;          ///< one row per body: tx ty tz qw qx qy qz

inline void copy_points(const Points& from, std::vector<Eigen::Vector3d>& to) {
    static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
    const auto* const first = reinterpret_cast<const Eigen::Vector3d*>(from.data());
    to.assign(first, first + from.shape(0));
}

/// Moves the values to memory that Python owns. Returns its address and the capsule that frees it.
template<class T>
std::pair<T*, nanobind::capsule> owned(std::vector<T> values) {
    auto* const storage = new std::vector<T>(std::move(values));
    return {storage->data(),
            nanobind::capsule(storage, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); })};
}

/// A NumPy array (rows, columns) over the memory of `values`. Each element is one row or one number of a row.
template<class Value, std::size_t columns, class T>
nanobind::ndarray<nanobind::numpy, Value, nanobind::shape<-1, columns>> owned_array(std::vector<T> values) {
    const auto rows = values.size() * sizeof(T) / (columns * sizeof(Value));
    const auto [data, owner] = owned(std::move(values));
    return {data, {rows, columns}, owner};
}

} // namespace tandem::python
