// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <fmt/format.h>
#include <string_view>

/// Common parts of all formats. In is Scanner or Cursor.
namespace tandem::read {

template<class In>
Eigen::Vector3d get_point(In& in) {
    const double x = in.template get<double>("coordinate x");
    const double y = in.template get<double>("coordinate y");
    const double z = in.template get<double>("coordinate z");
    return {x, y, z};
}

/// Converts `index`, counted from `first`, to an index from 0 into `count` vertices. Fails when out of range;
/// an index of `count` may mean that a file counts from 1 where its format counts from 0.
template<class In>
std::uint32_t check_index(const In& in, std::int64_t index, std::int64_t first, std::size_t count) {
    const auto last = first + static_cast<std::int64_t>(count) - 1;
    if (index < first || index > last)
        in.fail(fmt::format("vertex {} is out of range: the mesh has {} to {}", index, first, last),
                first == 0 && index == last + 1 ? "number vertices from 0, or repair the mesh"
                                                : "repair the mesh");
    return static_cast<std::uint32_t>(index - first);
}

/// Reads four vertex indices counted from `first`.
template<class In>
std::array<std::uint32_t, 4> get_tetrahedron(In& in, std::int64_t first, std::size_t count) {
    std::array<std::uint32_t, 4> corners{};
    for (auto& corner : corners)
        corner = check_index(in, in.template get<std::int64_t>("a vertex number"), first, count);
    return corners;
}

} // namespace tandem::read
