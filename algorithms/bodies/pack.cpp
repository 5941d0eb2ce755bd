// SPDX-License-Identifier: MIT
#include "algorithms/bodies/pack.h"

#include <cmath>
#include <cstring>

namespace tandem {

namespace {

template<class Real, class Numbers>
void append(std::vector<std::byte>& out, const Numbers& numbers) {
    const auto offset = out.size();
    out.resize(offset + numbers.size() * sizeof(Real)); // once, because appending single numbers is slow
    auto* target = out.data() + offset;
    for (const double number : numbers) {
        const auto value = static_cast<Real>(number);
        std::memcpy(target, &value, sizeof(Real));
        target += sizeof(Real);
    }
}

/// The distance of a rounded vertex from the mesh's own origin, which is at -shift, rounded up.
template<class Real>
Real distance_of(const std::array<Real, 4>& row, const Eigen::Vector3d& shift) {
    constexpr double upwards = 1 + 0x1p-20;
    return static_cast<Real>(std::hypot(static_cast<double>(row[0]) + shift.x(),
                                        static_cast<double>(row[1]) + shift.y(),
                                        static_cast<double>(row[2]) + shift.z())
                             * upwards);
}

/// What the fourth reals of rows are: distances if `shift` is not null, else `given` numbers, else 0.
struct Fourth {
    const Eigen::Vector3d* shift = nullptr;
    std::span<const double> given{};
};

template<class Real>
void write_rows(std::byte* target, const OrderedMesh& mesh, const std::vector<Eigen::Vector3d>& vertices,
                const Fourth& fourth) {
    // Reads in the order of memory, because a new frame's vertices may not be in a cache; the written rows
    // fit into one.
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (mesh.numbers[i] == OrderedMesh::unused) continue;
        const auto& p = vertices[i];
        std::array<Real, 4> row{static_cast<Real>(p.x()), static_cast<Real>(p.y()), static_cast<Real>(p.z()),
                                0};
        if (fourth.shift != nullptr) row[3] = distance_of(row, *fourth.shift);
        if (!fourth.given.empty()) row[3] = static_cast<Real>(fourth.given[i]);
        std::memcpy(target + mesh.numbers[i] * sizeof(row), row.data(), sizeof(row));
    }
}

void write_rows_in(const Geometry& geometry, std::byte* out, const OrderedMesh& mesh,
                   const std::vector<Eigen::Vector3d>& vertices, const Fourth& fourth) {
    if (geometry.precision == Precision::fp64)
        write_rows<double>(out, mesh, vertices, fourth);
    else
        write_rows<float>(out, mesh, vertices, fourth);
}

void append_vertices(std::vector<std::byte>& out, const Geometry& geometry, const OrderedMesh& mesh,
                     const std::vector<Eigen::Vector3d>& vertices, const Fourth& fourth) {
    const auto offset = out.size();
    out.resize(offset + mesh.vertices.size() * 4 * real_bytes(geometry));
    write_rows_in(geometry, out.data() + offset, mesh, vertices, fourth);
}

} // namespace

void write_vertices(std::byte* out, const Geometry& geometry, const OrderedMesh& mesh,
                    const std::vector<Eigen::Vector3d>& vertices) {
    write_rows_in(geometry, out, mesh, vertices, {});
}

void pack_vertices(std::vector<std::byte>& out, const Geometry& geometry, const OrderedMesh& mesh,
                   const std::vector<Eigen::Vector3d>& vertices, std::span<const double> fourth) {
    append_vertices(out, geometry, mesh, vertices, {.given = fourth});
}

void pack_vertices_with_distances(std::vector<std::byte>& out, const Geometry& geometry,
                                  const OrderedMesh& mesh, const std::vector<Eigen::Vector3d>& vertices,
                                  const Eigen::Vector3d& shift) {
    append_vertices(out, geometry, mesh, vertices, {.shift = &shift});
}

/// The order of operations affects the bits of answers; the reference has the same order
/// (harness/verify/world_vertices.cpp).
std::array<double, 12> pose_rows(const Pose& pose) {
    const auto& q = pose.rotation;
    const double length = std::sqrt((q.w() * q.w() + q.x() * q.x()) + (q.y() * q.y() + q.z() * q.z()));
    const double w = q.w() / length;
    const double x = q.x() / length;
    const double y = q.y() / length;
    const double z = q.z() / length;
    const auto& t = pose.translation;
    return {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),     t.x(),
            2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),     t.y(),
            2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y), t.z()};
}

void pack_reals(std::vector<std::byte>& out, const Geometry& geometry, std::span<const double> numbers) {
    if (geometry.precision == Precision::fp64)
        append<double>(out, numbers);
    else
        append<float>(out, numbers);
}

void pack_pose(std::vector<std::byte>& out, const Geometry& geometry, const Pose& pose,
               const std::array<double, 3>& drift, double arc) {
    pack_reals(out, geometry, pose_rows(pose));
    if (pose_reals(geometry) == 16)
        pack_reals(out, geometry, std::array<double, 4>{drift[0], drift[1], drift[2], arc});
}

} // namespace tandem
