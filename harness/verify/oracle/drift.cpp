// SPDX-License-Identifier: MIT
#include "harness/verify/oracle/drift.h"

#include "algorithms/bodies/drift.h"
#include "algorithms/bodies/shift.h"
#include "harness/verify/oracle/posed.h"
#include "geometry/rounding.h"
#include "base/statistics.h"
#include "harness/verify/world_vertices.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tandem {

namespace {

using namespace oracle;

struct BodyDrift {
    std::vector<double> ulps; ///< by vertex
    double of_bound = 0;
};

/// The vertex in world coordinates, without rounding.
Vector<mpq_class> exact_vertex(const Scene& scene, const Frame& frame, std::size_t body, std::size_t vertex) {
    if (scene.bodies[body].deformable) {
        const auto& v = frame.deformed[body][vertex];
        return {mpq_class(v.x()), mpq_class(v.y()), mpq_class(v.z())};
    }
    const auto& v = scene.meshes[scene.bodies[body].mesh].vertices[vertex];
    return posed_point(frame.poses[body], {v.x(), v.y(), v.z()});
}

/// The spacing of the numbers of type Real at |x|.
template<class Real>
double spacing(double x) {
    const int least = std::numeric_limits<Real>::min_exponent - std::numeric_limits<Real>::digits;
    return std::ldexp(1.0, x == 0 ? least
                                  : std::max(std::ilogb(x) - std::numeric_limits<Real>::digits + 1, least));
}

/// Drift of one body by vertex. Differences are rationals that are rounded once.
template<class Real>
BodyDrift drift_in(const Scene& scene, const Frame& frame, std::size_t body, Origin origin) {
    constexpr auto precision = sizeof(Real) == 8 ? Precision::fp64 : Precision::fp32;
    const auto world = world_vertices<Real>(scene, frame, body, origin);
    const auto bound = scene.bodies[body].deformable ? drift_bound(frame.deformed[body], precision)
                                                     : drift_bound_of(scene, frame, body, precision, origin);
    BodyDrift result;
    for (std::size_t vertex = 0; vertex < world.size(); ++vertex) {
        const auto exact = exact_vertex(scene, frame, body, vertex);
        double off = 0;
        double largest = 0;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const auto at = static_cast<double>(world[vertex][axis]);
            const double along = std::fabs(nearest(mpq_class(at) - exact[axis]));
            off = std::max(off, along);
            largest = std::max({largest, std::fabs(at), std::fabs(nearest(exact[axis]))});
            if (along > 0) result.of_bound = std::max(result.of_bound, along / bound[axis]);
        }
        result.ulps.push_back(off / spacing<Real>(largest));
    }
    return result;
}

} // namespace

std::array<double, 3> drift_bound_of(const Scene& scene, const Frame& frame, std::size_t body,
                                     Precision precision, Origin origin) {
    const auto& mesh = scene.meshes[scene.bodies[body].mesh];
    const Eigen::Vector3d shift = origin == Origin::world ? Eigen::Vector3d::Zero() : shift_of(mesh);
    return drift_bound(shifted(frame.poses[body], shift), reach_of(mesh.vertices, -shift), precision, shift);
}

Drift vertex_drift(const Scene& scene, const Frame& frame, Precision precision, Origin origin) {
    std::vector<BodyDrift> bodies(scene.bodies.size());
    parallel_for(bodies.size(), [&](std::size_t body) {
        bodies[body] = precision == Precision::fp64 ? drift_in<double>(scene, frame, body, origin)
                                                    : drift_in<float>(scene, frame, body, origin);
    });
    Drift drift;
    std::vector<double> ulps;
    for (const auto& body : bodies) {
        ulps.insert(ulps.end(), body.ulps.begin(), body.ulps.end());
        drift.of_bound = std::max(drift.of_bound, body.of_bound);
    }
    drift.vertices = ulps.size();
    if (const auto summary = spread(std::move(ulps))) {
        drift.median = summary->median;
        drift.p99 = summary->p99;
        drift.max = summary->maximum;
    }
    return drift;
}

} // namespace tandem
