// SPDX-License-Identifier: MIT
#include "harness/verify/accuracy/hull.h"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <vector>

namespace tandem {

namespace {

using Eigen::Vector3d;

/// An affinely independent subset of the points, with the weights of its convex combination nearest to the
/// origin. The term is Wolfe's.
struct Corral {
    std::vector<Vector3d> points;
    std::vector<double> weights;

    Vector3d nearest() const {
        Vector3d sum = Vector3d::Zero();
        for (std::size_t i = 0; i < points.size(); ++i) sum += weights[i] * points[i];
        return sum;
    }
};

/// Weights, possibly negative, of the point of the affine hull nearest to the origin: the least norm with
/// weights that sum to 1. Solves the Gram matrix bordered by ones (Wolfe 1976, step 2).
Eigen::VectorXd affine_weights(const std::vector<Vector3d>& points) {
    const auto n = static_cast<Eigen::Index>(points.size());
    Eigen::MatrixXd system = Eigen::MatrixXd::Ones(n + 1, n + 1);
    system(n, n) = 0;
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)
            system(i, j) = points[static_cast<std::size_t>(i)].dot(points[static_cast<std::size_t>(j)]);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n + 1);
    right(n) = 1;
    return system.fullPivLu().solve(right).head(n);
}

/// Moves towards the nearest point of the affine hull and removes points whose weight reaches 0, until that
/// point is in the corral's convex hull.
void minimise(Corral& corral) {
    while (true) {
        const auto affine = affine_weights(corral.points);
        if ((affine.array() > 0).all()) {
            for (std::size_t i = 0; i < corral.points.size(); ++i)
                corral.weights[i] = affine(static_cast<Eigen::Index>(i));
            return;
        }
        // The largest step that keeps all weights non-negative; remove the point whose weight becomes 0
        // (Wolfe's step 3).
        double step = 1;
        std::size_t removed = 0;
        for (std::size_t i = 0; i < corral.points.size(); ++i) {
            const double target = affine(static_cast<Eigen::Index>(i));
            if (target > 0) continue;
            const double limit = corral.weights[i] / (corral.weights[i] - target);
            if (limit <= step) {
                step = limit;
                removed = i;
            }
        }
        for (std::size_t i = 0; i < corral.points.size(); ++i)
            corral.weights[i] += step * (affine(static_cast<Eigen::Index>(i)) - corral.weights[i]);
        corral.points.erase(corral.points.begin() + static_cast<std::ptrdiff_t>(removed));
        corral.weights.erase(corral.weights.begin() + static_cast<std::ptrdiff_t>(removed));
        if (corral.points.size() == 1) {
            corral.weights[0] = 1;
            return;
        }
    }
}

} // namespace

double distance_to_hull(std::span<const std::array<double, 3>> vertices, const std::array<double, 3>& point) {
    std::vector<Vector3d> points;
    double size = 0;
    for (const auto& v : vertices) {
        points.emplace_back(v[0] - point[0], v[1] - point[1], v[2] - point[2]);
        size = std::max(size, points.back().squaredNorm());
    }
    const auto by_norm = [](const Vector3d& p, const Vector3d& q) {
        return p.squaredNorm() < q.squaredNorm();
    };
    Corral corral{{*std::min_element(points.begin(), points.end(), by_norm)}, {1}};
    auto nearest = corral.points.front();
    // Wolfe's stopping criterion: along the nearest point, no other point is nearer to the origin, up to
    // rounding.
    const double tolerance = 8 * std::numeric_limits<double>::epsilon() * size;
    // Each iteration reduces the distance, so that the loop ends. The limit guards against cycles by
    // rounding.
    for (std::size_t iteration = 0; iteration < 16 * points.size(); ++iteration) {
        const auto along = std::min_element(points.begin(), points.end(), [&](const auto& p, const auto& q) {
            return nearest.dot(p) < nearest.dot(q);
        });
        if (nearest.squaredNorm() - nearest.dot(*along) <= tolerance) break;
        if (std::find(corral.points.begin(), corral.points.end(), *along) != corral.points.end()) break;
        if (corral.points.size() == 4) return 0; // inside a tetrahedron of these points
        corral.points.push_back(*along);
        corral.weights.push_back(0);
        minimise(corral);
        const Vector3d next = corral.nearest();
        if (!(next.squaredNorm() < nearest.squaredNorm())) break;
        nearest = next;
    }
    return corral.points.size() == 4 ? 0 : nearest.norm();
}

double hausdorff_distance(std::span<const std::array<double, 3>> p,
                          std::span<const std::array<double, 3>> q) {
    const auto squared = [](const auto& a, const auto& b) {
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
        return sum;
    };
    const auto one_sided = [&](auto from, auto to) {
        double most = 0;
        for (const auto& a : from) {
            double least = std::numeric_limits<double>::max();
            for (const auto& b : to) least = std::min(least, squared(a, b));
            most = std::max(most, least);
        }
        return most;
    };
    return std::sqrt(std::max(one_sided(p, q), one_sided(q, p)));
}

} // namespace tandem
