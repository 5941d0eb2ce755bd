// SPDX-License-Identifier: MIT
#include "harness/verify/accuracy/answer_errors.h"

#include "geometry/exact_distance.h"
#include "geometry/exact_polygon.h"
#include "harness/verify/accuracy/hull.h"
#include "geometry/volume.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tandem {

namespace {

void append(std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

bool finite(const ContactPoint& c) {
    const auto is_finite = [](double value) { return std::isfinite(value); };
    return is_finite(c.depth) && std::all_of(c.point.begin(), c.point.end(), is_finite)
           && std::all_of(c.normal.begin(), c.normal.end(), is_finite);
}

/// The contacts of one pair in the sorted list.
std::span<const ContactPoint> contacts_of(std::span<const ContactPoint> contacts, const Pair& pair) {
    // Compare only the pair, because a pair may have several contacts.
    const auto [first, last] =
        std::equal_range(contacts.begin(), contacts.end(), ContactPoint{pair, 0, {}, {}, 0},
                         [](const auto& a, const auto& b) { return a.pair < b.pair; });
    return {first, last};
}

/// Finds the contacts of ascending pairs in one pass over the list.
class ContactCursor {
public:
    /// `first` is the first pair to find.
    ContactCursor(std::span<const ContactPoint> sorted, const Pair& first)
        : rest_(contacts_of(sorted, first).data(), sorted.data() + sorted.size()) {}

    std::span<const ContactPoint> find(const Pair& pair) {
        std::size_t skipped = 0;
        while (skipped < rest_.size() && rest_[skipped].pair < pair) ++skipped;
        rest_ = rest_.subspan(skipped);
        std::size_t count = 0;
        while (count < rest_.size() && rest_[count].pair == pair) ++count;
        return rest_.first(count);
    }

private:
    std::span<const ContactPoint> rest_;
};

/// Column of the decision matrix: 0 no contact, 1 only without penetration, 2 with penetration.
unsigned answer_column(std::span<const ContactPoint> contacts) {
    if (contacts.empty()) return 0;
    return std::any_of(contacts.begin(), contacts.end(), [](const auto& c) { return c.depth < 0; }) ? 2 : 1;
}

double length(const std::array<double, 3>& p, const std::array<double, 3>& q) {
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

/// Degrees between two directions.
double angle(const std::array<double, 3>& n, const std::array<double, 3>& m) {
    const double sine =
        std::hypot(n[1] * m[2] - n[2] * m[1], n[2] * m[0] - n[0] * m[2], n[0] * m[1] - n[1] * m[0]);
    return std::atan2(sine, n[0] * m[0] + n[1] * m[1] + n[2] * m[2]) * 180 / std::numbers::pi;
}

/// Adds the samples of one pair.
void compare(const ContactTruth& truth, double size, std::span<const ContactPoint> contacts, double unit,
             bool measures, ContactErrors& errors) {
    ++errors.overlapping;
    if (contacts.empty()) {
        ++errors.unanswered;
        return;
    }
    if (const auto bad =
            std::count_if(contacts.begin(), contacts.end(), [](const auto& c) { return !finite(c); });
        bad > 0) {
        errors.not_finite += static_cast<std::uint64_t>(bad);
        return;
    }
    // Depth is a signed distance, negative inside.
    const auto& deepest = *std::min_element(contacts.begin(), contacts.end(),
                                            [](const auto& a, const auto& b) { return a.depth < b.depth; });
    const double error = std::abs(-deepest.depth - truth.depth);
    errors.depth_relative.push_back(error / truth.depth);
    errors.depth_ulps.push_back(error / (unit * size));
    errors.normal_degrees.push_back(nearest_angle(truth.normals, deepest.normal));
    if (measures) return;
    double farthest = 0;
    std::vector<std::array<double, 3>> points;
    for (const auto& c : contacts) {
        farthest = std::max(farthest, distance_to_hull(truth.vertices, c.point));
        points.push_back(c.point);
    }
    errors.point.push_back(farthest / size);
    errors.hausdorff.push_back(hausdorff_distance(points, truth.vertices) / size);
    if (truth.volume > 0)
        errors.volume_relative.push_back(std::abs(hull_volume(points) - truth.volume) / truth.volume);
    else
        ++errors.no_volume;
}

} // namespace

void ContactErrors::add(const ContactErrors& other) {
    overlapping += other.overlapping;
    unanswered += other.unanswered;
    not_finite += other.not_finite;
    append(depth_relative, other.depth_relative);
    append(depth_ulps, other.depth_ulps);
    append(normal_degrees, other.normal_degrees);
    append(point, other.point);
    append(hausdorff, other.hausdorff);
    append(volume_relative, other.volume_relative);
    no_volume += other.no_volume;
    append(distance_ulps, other.distance_ulps);
    append(polygon_ulps, other.polygon_ulps);
}

std::optional<double> AnswerErrors::candidate_ratio() const {
    if (meeting() == 0) return std::nullopt;
    return static_cast<double>(pairs.candidates) / static_cast<double>(meeting());
}

std::optional<double> AnswerErrors::missed_upper95() const {
    if (meeting() == 0 || missed() > 0) return std::nullopt;
    return std::min(1.0, 3 / static_cast<double>(meeting()));
}

void AnswerErrors::add(const AnswerErrors& other) {
    frames += other.frames;
    pairs.add(other.pairs);
    decided.add(other.decided);
    invalid_tetrahedra += other.invalid_tetrahedra;
    every_contact = every_contact && other.every_contact;
    if (!drift) drift = other.drift;
    if (other.decisions) {
        if (!decisions) decisions.emplace();
        for (unsigned row = 0; row < 3; ++row)
            for (unsigned column = 0; column < 3; ++column)
                (*decisions)[row][column] += (*other.decisions)[row][column];
    }
    if (other.rounding) {
        if (!rounding) rounding.emplace();
        rounding->add(*other.rounding);
    }
    if (other.contacts) {
        if (!contacts) contacts.emplace();
        contacts->add(*other.contacts);
    }
}

DecisionMatrix decision_matrix(const FrameTruth& truth, std::span<const Pair> candidates,
                               std::span<const ContactPoint> contacts) {
    DecisionMatrix matrix{};
    const auto count_row = [&](unsigned row, std::span<const Pair> pairs, auto counts) {
        // Each parallel part positions its cursors by one search; they then follow its pairs.
        const auto parts = in_parts(pairs);
        std::vector<std::array<std::uint64_t, 3>> found(parts.size());
        parallel_for(parts.size(), [&](std::size_t i) {
            ContactCursor cursor(contacts, parts[i].front());
            auto counted = counts(parts[i].front());
            for (const auto& pair : parts[i]) {
                const auto answer = cursor.find(pair);
                if (counted(pair)) ++found[i][answer_column(answer)];
            }
        });
        for (const auto& part : found)
            for (unsigned column = 0; column < 3; ++column) matrix[row][column] += part[column];
    };
    // A candidate in neither list is in row 0; the two lists are rows 1 and 2.
    const auto every = [](const Pair&) { return [](const Pair&) { return true; }; };
    count_row(0, candidates, [&](const Pair& first) {
        return [touching = PairCursor(truth.touching, first),
                overlapping = PairCursor(truth.overlapping, first)](const Pair& pair) mutable {
            return !touching.contains(pair) && !overlapping.contains(pair);
        };
    });
    count_row(1, truth.touching, every);
    count_row(2, truth.overlapping, every);
    return matrix;
}

ContactTruths contact_truths(const Scene& scene, const Frame& frame, Positions positions,
                             const FrameTruth& truth, std::size_t most, const Eigen::Vector3d& origin) {
    ContactTruths result;
    const auto& all = truth.overlapping;
    const auto count = most == 0 ? all.size() : std::min(most, all.size());
    result.every = count == all.size();
    std::vector<Pair> chosen;
    // Choose evenly over the order, which is by bodies: the first pairs would cover only a part of the scene.
    for (std::size_t i = 0; i < count; ++i) chosen.push_back(all[i * all.size() / count]);
    auto corners = pair_corners(scene, frame, positions, chosen);
    for (auto& pair : corners)
        for (auto& tetrahedron : pair)
            for (auto& corner : tetrahedron)
                for (unsigned axis = 0; axis < 3; ++axis) corner[axis] += origin[axis];
    std::vector<std::optional<ContactTruth>> truths(chosen.size());
    parallel_for(chosen.size(),
                 [&](std::size_t i) { truths[i] = contact_truth(corners[i][0], corners[i][1]); });
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (!truths[i]) continue; // a pair without volume has no depth
        result.pairs.push_back(chosen[i]);
        result.truths.push_back(std::move(*truths[i]));
        result.sizes.push_back(std::max(longest_edge(corners[i][0]), longest_edge(corners[i][1])));
    }
    return result;
}

double longest_edge(const TetraCorners& corners) {
    double most = 0;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned j = 0; j < i; ++j) most = std::max(most, length(corners[i], corners[j]));
    return most;
}

double nearest_angle(std::span<const std::array<double, 3>> normals, const std::array<double, 3>& normal) {
    double least = 180;
    for (const auto& n : normals) least = std::min(least, angle(n, normal));
    return least;
}

ContactErrors contact_errors(const ContactTruths& truths, std::span<const ContactPoint> contacts, double unit,
                             bool measures) {
    constexpr std::size_t part = 256;
    std::vector<ContactErrors> parts((truths.pairs.size() + part - 1) / part);
    parallel_for(parts.size(), [&](std::size_t index) {
        const auto end = std::min(truths.pairs.size(), (index + 1) * part);
        for (auto i = index * part; i < end; ++i)
            compare(truths.truths[i], truths.sizes[i], contacts_of(contacts, truths.pairs[i]), unit, measures,
                    parts[index]);
    });
    ContactErrors errors;
    for (const auto& one : parts) errors.add(one);
    return errors;
}

std::vector<double> distance_errors(const Scene& scene, const Frame& frame, Positions positions,
                                    std::span<const ContactPoint> contacts, double unit, std::size_t most) {
    const auto count = most == 0 ? contacts.size() : std::min(most, contacts.size());
    std::vector<Pair> pairs;
    std::vector<double> distances;
    for (std::size_t i = 0; i < count; ++i) {
        const auto& contact = contacts[i * contacts.size() / count];
        pairs.push_back(contact.pair);
        distances.push_back(contact.depth);
    }
    const auto corners = pair_corners(scene, frame, positions, pairs);
    std::vector<std::optional<double>> errors(count);
    parallel_for(count, [&](std::size_t i) {
        const auto& [a, b] = corners[i];
        if (const auto exact = exact_distance(a, b))
            errors[i] = std::abs(distances[i] - *exact) / (unit * std::max(longest_edge(a), longest_edge(b)));
    });
    std::vector<double> result;
    for (const auto& error : errors)
        if (error) result.push_back(*error);
    return result;
}

namespace {

/// The pressures at a tetrahedron's corners; none for a mesh without a field.
std::optional<std::array<double, 4>> pressures_of(const Scene& scene, std::uint32_t body,
                                                  std::uint32_t tetrahedron) {
    const auto& mesh = scene.meshes[scene.bodies[body].mesh];
    if (mesh.pressures.empty()) return std::nullopt;
    std::array<double, 4> values;
    for (unsigned i = 0; i < 4; ++i) values[i] = mesh.pressures[mesh.tetrahedra[tetrahedron][i]];
    return values;
}

} // namespace

ContactErrors polygon_errors(const Scene& scene, const Frame& frame, Positions positions,
                             const PolygonAnswer& answer, double unit, std::size_t most) {
    const auto& all = answer.truth.overlapping;
    const auto count = most == 0 ? all.size() : std::min(most, all.size());
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < count; ++i) pairs.push_back(all[i * all.size() / count]);
    const auto corners = pair_corners(scene, frame, positions, pairs);
    std::vector<ContactErrors> parts(count);
    parallel_for(count, [&](std::size_t i) {
        auto& errors = parts[i];
        const auto& [a, b] = corners[i];
        const auto of_a = pressures_of(scene, pairs[i].body_a, pairs[i].tet_a);
        const auto of_b = pressures_of(scene, pairs[i].body_b, pairs[i].tet_b);
        errors.overlapping = 1;
        const auto rows = contacts_of(answer.polygons, pairs[i]);
        const auto exact = of_a && of_b ? exact_polygon(a, *of_a, b, *of_b) : std::nullopt;
        if (exact && rows.empty()) errors.unanswered = 1;
        if (!exact && rows.empty()) return;
        const double area = rows.empty() ? 0 : rows.front().depth;
        const double length = std::max(longest_edge(a), longest_edge(b));
        errors.polygon_ulps = {std::abs(area - (exact ? exact->area : 0)) / (unit * length * length)};
    });
    ContactErrors errors;
    for (const auto& one : parts) errors.add(one);
    return errors;
}

} // namespace tandem
