// SPDX-License-Identifier: MIT
#include "geometry/intervals.h"

#include "geometry/common_point.h"
#include "geometry/facets.h"
#include "geometry/filter.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace tandem::geometry {

namespace {

using Direction = Vector<double>;

double largest_of(const TetraCorners& corners) {
    double result = 0;
    for (const auto& corner : corners)
        for (const double x : corner) result = std::max(result, std::fabs(x));
    return result;
}

/// An upper bound of the distances of corners from the axis of rotation.
double radius_of(const TetraCorners& across) {
    double result = 0;
    for (const auto& q : across) result = std::max(result, std::sqrt(dot(q, q)));
    return result * (1 + 0x1p-40);
}

/// Both tetrahedra relative to the straight path of a's first corner, in units that make the largest
/// coordinate about 1.
class ScaledPair {
public:
    ScaledPair(const MovingTetra& a, const MovingTetra& b) : bodies_{a, b} {
        const auto from = a.from[0], to = a.to[0];
        double size = 0;
        for (auto& body : bodies_) {
            for (auto& corner : body.from) corner = minus(corner, from);
            for (auto& corner : body.to) corner = minus(corner, to);
            size = std::max({size, largest_of(body.from), largest_of(body.to)});
        }
        usable_ = size > 0x1p-300 && size < 0x1p300;
        if (!usable_) return;
        const int exponent = -std::ilogb(size) - 1;
        for (auto& body : bodies_) scale(body, exponent);
        // Differences, a mean of two ends and an arc have less than 16 roundings of numbers below 1 and the
        // radius. Two products with an axis have less than twice that.
        error_ = 0x1p-49 * (1 + radius(0) + radius(1)) + std::max(bodies_[0].off, bodies_[1].off);
        usable_ = std::isfinite(error_);
    }

    /// Whether sizes are far from underflow and overflow.
    bool usable() const { return usable_; }
    /// Error bound of a coordinate of at().
    double error() const { return error_; }

    TetraCorners at(unsigned index, double s) const {
        const auto& body = bodies_[index];
        const double half = std::sin(0.5 * s * body.angle), full = std::sin(0.5 * body.angle);
        const double inwards = 2 * (s * full * full - half * half);
        const double sideways = std::sin(s * body.angle) - s * std::sin(body.angle);
        TetraCorners result;
        for (unsigned i = 0; i < 4; ++i)
            for (unsigned axis = 0; axis < 3; ++axis) {
                result[i][axis] = body.from[i][axis] + s * (body.to[i][axis] - body.from[i][axis]);
                if (body.angle > 0)
                    result[i][axis] += inwards * body.across[i][axis] + sideways * body.along[i][axis];
            }
        return result;
    }

    /// How far arcs of both leave their chords over a time, at most.
    double leaves_chord(double time) const {
        double sum = 0;
        for (unsigned i = 0; i < 2; ++i) sum += std::pow(bodies_[i].angle * time, 2) / 8 * radius(i);
        return sum * (1 + 0x1p-40);
    }

    /// The motion of b's first corner relative to a's.
    Direction relative_motion() const { return minus(bodies_[1].to[0], bodies_[1].from[0]); }

private:
    double radius(unsigned index) const { return bodies_[index].angle > 0 ? radius_[index] : 0; }

    void scale(MovingTetra& body, int exponent) {
        for (auto* corners : {&body.from, &body.to, &body.across, &body.along})
            for (auto& corner : *corners)
                for (double& x : corner) x = std::ldexp(x, exponent);
        body.off = std::ldexp(body.off, exponent);
        radius_[&body - bodies_.data()] = radius_of(body.across);
    }

    std::array<MovingTetra, 2> bodies_;
    std::array<double, 2> radius_{};
    double error_ = 0;
    bool usable_ = false;
};

/// Least minus greatest product with an axis, of b over a and of a over b. The greater one is the gap.
std::array<double, 2> gaps(const TetraCorners& a, const TetraCorners& b, const Direction& axis) {
    double low[2], high[2];
    for (unsigned body = 0; body < 2; ++body) {
        const auto& corners = body == 0 ? a : b;
        low[body] = high[body] = dot(axis, corners[0]);
        for (unsigned i = 1; i < 4; ++i) {
            const double x = dot(axis, corners[i]);
            low[body] = std::min(low[body], x);
            high[body] = std::max(high[body], x);
        }
    }
    return {low[1] - high[0], low[0] - high[1]};
}

/// The axis with its largest component 1; no value when it has no length to speak of.
std::optional<Direction> normalised(Direction axis) {
    const double size = std::max({std::fabs(axis[0]), std::fabs(axis[1]), std::fabs(axis[2])});
    if (!(size > 0x1p-200)) return std::nullopt;
    for (double& x : axis) x /= size;
    return axis;
}

/// Corners at the ends of an interval and at its middle.
struct Interval {
    double low, high;
    std::array<TetraCorners, 2> at_low, at_high, at_middle;

    Interval(const ScaledPair& pair, double from, double to) : low(from), high(to) {
        for (unsigned i = 0; i < 2; ++i) {
            at_low[i] = pair.at(i, low);
            at_high[i] = pair.at(i, high);
            at_middle[i] = pair.at(i, middle());
        }
    }
    double middle() const { return 0.5 * (low + high); }
};

bool separates(const ScaledPair& pair, const Interval& interval, const Direction& direction) {
    const auto axis = normalised(direction);
    if (!axis) return false;
    const auto first = gaps(interval.at_low[0], interval.at_low[1], *axis);
    const auto last = gaps(interval.at_high[0], interval.at_high[1], *axis);
    const double sum = std::fabs((*axis)[0]) + std::fabs((*axis)[1]) + std::fabs((*axis)[2]);
    const double least =
        4 * pair.error() * sum
        + pair.leaves_chord(interval.high - interval.low) * std::sqrt(dot(*axis, *axis)) * (1 + 0x1p-40);
    return std::min(first[0], last[0]) > least || std::min(first[1], last[1]) > least;
}

/// Tries normals of faces and products of edges at the middle, and products of edges with the relative
/// motion, which separate swept volumes.
bool is_separated(const ScaledPair& pair, const Interval& interval) {
    const auto try_axis = [&](const Direction& axis) { return separates(pair, interval, axis); };
    if (try_axis({1, 0, 0}) || try_axis({0, 1, 0}) || try_axis({0, 0, 1})) return true;
    std::array<std::array<Direction, 6>, 2> sides;
    for (unsigned body = 0; body < 2; ++body) {
        const auto& corners = interval.at_middle[body];
        for (unsigned i = 0; i < 6; ++i) sides[body][i] = minus(corners[edges[i].to], corners[edges[i].from]);
        for (const auto& face : faces) {
            const auto& p = corners[face[0]];
            if (try_axis(cross(minus(corners[face[1]], p), minus(corners[face[2]], p)))) return true;
        }
    }
    for (const auto& p : sides[0])
        for (const auto& q : sides[1])
            if (try_axis(cross(p, q))) return true;
    const auto motion = pair.relative_motion();
    return std::ranges::any_of(sides, [&](const auto& own) {
        return std::ranges::any_of(own, [&](const auto& side) { return try_axis(cross(side, motion)); });
    });
}

bool overlap_at_middle(const ScaledPair& pair, const Interval& interval) {
    const auto& [a, b] = interval.at_middle;
    const auto point = common_point(a, b);
    return point && certainly_inside(*point, a, pair.error()) && certainly_inside(*point, b, pair.error());
}

} // namespace

Meeting meet_by_intervals(const MovingTetra& a, const MovingTetra& b, const IntervalLimits& limits) {
    const ScaledPair pair(a, b);
    if (!pair.usable()) return Meeting::undecided;
    std::vector<std::array<double, 2>> open{{0, 1}};
    for (unsigned depth = 0;; ++depth) {
        std::vector<std::array<double, 2>> next;
        for (const auto& [low, high] : open) {
            const Interval interval(pair, low, high);
            if (overlap_at_middle(pair, interval)) return Meeting::meeting;
            if (is_separated(pair, interval)) continue;
            next.push_back({low, interval.middle()});
            next.push_back({interval.middle(), high});
        }
        if (next.empty()) return Meeting::apart;
        if (depth == limits.depth || next.size() > limits.widest) return Meeting::undecided;
        open = std::move(next);
    }
}

} // namespace tandem::geometry
