// SPDX-License-Identifier: MIT
#include "algorithms/bodies/range.h"

#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

/// Infinite if a coordinate is NaN, because a maximum would ignore NaN.
double largest(const Eigen::Vector3d& point) {
    return point.hasNaN() ? std::numeric_limits<double>::infinity() : point.lpNorm<Eigen::Infinity>();
}

double largest(const std::vector<Eigen::Vector3d>& points) {
    double size = 0;
    for (const auto& p : points) size = std::max(size, largest(p));
    return size;
}

/// Throws InputError that names the first vertex with a coordinate that is not finite.
void check_finite(const std::vector<Eigen::Vector3d>& vertices, std::size_t body) {
    for (std::size_t v = 0; v < vertices.size(); ++v)
        if (!vertices[v].allFinite())
            throw InputError(fmt::format("body {}: vertex {} is not finite; repair the frame", body, v));
}

/// Checks bodies one by one.
class RangeCheck {
public:
    RangeCheck(const Scene& scene, const Frame& frame, Precision precision)
        : scene_(scene), frame_(frame), precision_(precision), limit_(largest_coordinate(precision)) {
        for (const auto& mesh : scene.meshes) mesh_sizes_.push_back(largest(mesh.vertices));
    }

    void check(std::size_t body) const {
        const bool is_deformable = scene_.bodies[body].deformable;
        if (is_deformable) check_finite(frame_.deformed[body], body);
        const double size =
            is_deformable ? largest(frame_.deformed[body]) : mesh_sizes_[scene_.bodies[body].mesh];
        const double reach = std::max(size, largest(frame_.poses[body].translation));
        if (reach <= limit_) return;
        const bool is_double = precision_ == Precision::fp64;
        throw InputError(
            fmt::format("body {} has a coordinate of {:g}, and precision={} takes at most {:g}; {}", body,
                        reach, is_double ? "double" : "float", limit_,
                        is_double ? "choose larger units" : "use precision=double or larger units"));
    }

private:
    const Scene& scene_;
    const Frame& frame_;
    Precision precision_;
    double limit_;
    std::vector<double> mesh_sizes_;
};

} // namespace

double largest_coordinate(Precision precision) { return precision == Precision::fp64 ? 1e306 : 1e36; }

void check_range(const Scene& scene, const Frame& frame, Precision precision) {
    const RangeCheck range(scene, frame, precision);
    for (std::size_t body = 0; body < scene.bodies.size(); ++body) range.check(body);
}

void check_range_of(const Scene& scene, const Frame& frame, Precision precision,
                    std::span<const std::uint32_t> bodies) {
    const RangeCheck range(scene, frame, precision);
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        if (scene.bodies[body].fixed) range.check(body);
    for (const auto body : bodies) range.check(body);
}

} // namespace tandem
