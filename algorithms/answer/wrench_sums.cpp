// SPDX-License-Identifier: MIT
#include "algorithms/answer/wrench_sums.h"

#include "algorithms/bodies/pack.h"
#include "algorithms/bodies/shift.h"
#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr double deformable_reach = 0x1p10; ///< times the size; points may be 2^8 times as far

/// The least power of two that is not below a length; 1 for 0.
double power_above(double length) {
    int exponent = 0;
    if (!(length > 0)) return 1;
    const double share = std::frexp(length, &exponent);
    return std::ldexp(1.0, share == 0.5 ? exponent - 1 : exponent);
}

BodyArm arm_of(const Scene& scene, std::size_t number) {
    const auto& mesh = scene.meshes[number];
    BodyArm arm;
    Eigen::AlignedBox3d box;
    const Eigen::Vector3d pivot = -shift_in(scene, number);
    std::copy_n(pivot.data(), 3, arm.pivot.begin());
    double reach = 0;
    for (const auto& tetrahedron : mesh.tetrahedra)
        for (const auto vertex : tetrahedron) {
            box.extend(mesh.vertices[vertex]);
            reach = std::max(reach, (mesh.vertices[vertex] - pivot).norm());
        }
    arm.size = power_above(box.diagonal().norm());
    arm.reach = power_above(reach);
    if (!mesh.pressures.empty()) arm.pressure = power_above(std::ranges::max(mesh.pressures) / 2);
    return arm;
}

/// Sums of forces and torques are shares of their units down to a rounding error.
void check_units(const BodyArm& arm, Precision precision) {
    const bool is_double = precision == Precision::fp64;
    const double least = is_double ? 0x1p-970 : 0x1p-103;
    const double area = arm.size * arm.size, force = area * arm.pressure, torque = force * arm.reach;
    if (std::min(force, torque) >= least) return;
    throw InputError(fmt::format(
        "output=wrenches: a body {:g} wide, whose pressures reach {:g}, makes forces or "
        "torques too small for precision={}; choose {}other units",
        arm.size, arm.pressure, is_double ? "double" : "float", is_double ? "" : "precision=double or "));
}

} // namespace

std::vector<BodyArm> body_arms(const Scene& scene) {
    std::vector<BodyArm> of_meshes, arms;
    for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh) of_meshes.push_back(arm_of(scene, mesh));
    for (const auto& body : scene.bodies) {
        arms.push_back(of_meshes[body.mesh]);
        if (!body.deformable) continue;
        arms.back().pivot = {};
        arms.back().reach = deformable_reach * arms.back().size;
    }
    return arms;
}

std::vector<std::byte> packed_arms(const std::vector<BodyArm>& arms, const Geometry& geometry) {
    std::vector<double> numbers;
    for (const auto& arm : arms) check_units(arm, geometry.precision);
    for (const auto& arm : arms)
        numbers.insert(numbers.end(),
                       {arm.pivot[0], arm.pivot[1], arm.pivot[2], arm.size, arm.reach, arm.pressure, 0, 0});
    std::vector<std::byte> bytes;
    pack_reals(bytes, geometry, numbers);
    return bytes;
}

template<class Real>
WrenchSums<Real>::WrenchSums(const BodyArm& a, const BodyArm& b, const std::array<Real, 12>& pose)
    : pressure_(static_cast<Real>(std::min(a.pressure, b.pressure))), reach_(static_cast<Real>(a.reach)) {
    const auto size = static_cast<Real>(std::min(a.size, b.size));
    area_ = size * size;
    std::array<Real, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = static_cast<Real>(a.pivot[i]);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto* row = pose.data() + 4 * i;
        pivot_[i] = ((row[0] * p[0] + row[1] * p[1]) + row[2] * p[2]) + row[3];
    }
}

template<class Real>
void WrenchSums<Real>::add_number(std::size_t part, Real number) {
    const Real scaled = number * Real(0x1p23);
    if (!(std::abs(scaled) < Real(0x1p31))) throw InputError(std::string(wrench_too_large));
    const auto whole = static_cast<std::int64_t>(scaled);
    const Real rest = (scaled - static_cast<Real>(whole)) * Real(0x1p32);
    whole_[part] += whole;
    rest_[part] += static_cast<std::int64_t>(rest + (rest < 0 ? Real(-0.5) : Real(0.5)));
}

template<class Real>
void WrenchSums<Real>::add(const std::array<Real, 3>& centroid, const std::array<Real, 3>& normal, Real area,
                           Real pressure) {
    const Real amount = (area / area_) * (pressure / pressure_);
    std::array<Real, 3> force, arm;
    for (std::size_t i = 0; i < 3; ++i) {
        force[i] = normal[i] * amount;
        arm[i] = (centroid[i] - pivot_[i]) / reach_;
        add_number(i, force[i]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const auto j = (i + 1) % 3, k = (i + 2) % 3;
        add_number(3 + i, arm[j] * force[k] - arm[k] * force[j]);
    }
    add_number(6, area / area_);
    ++polygons_;
}

template<class Real>
std::array<Real, WrenchSums<Real>::parts> WrenchSums<Real>::values() const {
    std::array<Real, parts> result;
    for (std::size_t i = 0; i < parts; ++i) {
        __extension__ using Wide = __int128;
        Wide sum = (static_cast<Wide>(whole_[i]) << 32) + rest_[i];
        const bool is_negative = sum < 0;
        if (is_negative) sum = -sum;
        const auto whole = static_cast<std::uint64_t>(sum >> 32);
        const auto rest = static_cast<std::uint64_t>(sum) & 0xffffffffu;
        const Real magnitude =
            (static_cast<Real>(whole) + static_cast<Real>(rest) / Real(0x1p32)) * Real(0x1p-23);
        Real value = (is_negative ? -magnitude : magnitude) * area_;
        if (i < 6) value = value * pressure_;
        if (i >= 3 && i < 6) value = value * reach_;
        if (!std::isfinite(value)) throw InputError(std::string(wrench_too_large));
        result[i] = value + Real(0);
    }
    return result;
}

template class WrenchSums<float>;
template class WrenchSums<double>;

} // namespace tandem
