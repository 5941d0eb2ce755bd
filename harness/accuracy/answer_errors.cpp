// SPDX-License-Identifier: MIT
#include "harness/accuracy/answer_errors.h"

#include "harness/accuracy/hull.h"
#include "harness/oracle/volume.h"
#include "scenes/parallel.h"

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
    const auto [first, last] =
        std::equal_range(contacts.begin(), contacts.end(), ContactPoint{pair, 0, {}, {}, 0},
                         [](const auto& a, const auto& b) { return a.pair < b.pair; });
    return {first, last};
}

/// 0: no contact, 1: none inside, 2: one inside.
unsigned answered(std::span<const ContactPoint> contacts) {
    if (contacts.empty()) return 0;
    return std::any_of(contacts.begin(), contacts.end(), [](const auto& c) { return c.depth < 0; }) ? 2 : 1;
}

double length(const std::array<double, 3>& p, const std::array<double, 3>& q) {
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

double longest_edge(const TetraCorners& corners) {
    double most = 0;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned j = 0; j < i; ++j) most = std::max(most, length(corners[i], corners[j]));
    return most;
}

/// Degrees between two directions; exact for small angles, where an arc cosine is not.
double angle(const std::array<double, 3>& n, const std::array<double, 3>& m) {
    const double sine =
        std::hypot(n[1] * m[2] - n[2] * m[1], n[2] * m[0] - n[0] * m[2], n[0] * m[1] - n[1] * m[0]);
    return std::atan2(sine, n[0] * m[0] + n[1] * m[1] + n[2] * m[2]) * 180 / std::numbers::pi;
}

double nearest_angle(const std::vector<std::array<double, 3>>& normals, const std::array<double, 3>& normal) {
    double least = 180;
    for (const auto& n : normals) least = std::min(least, angle(n, normal));
    return least;
}

/// Adds the samples of one pair.
void compare(const ContactTruth& truth, double size, std::span<const ContactPoint> contacts, double unit,
             ContactErrors& errors) {
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
    const auto& deepest = *std::min_element(contacts.begin(), contacts.end(),
                                            [](const auto& a, const auto& b) { return a.depth < b.depth; });
    const double wrong = std::abs(-deepest.depth - truth.depth);
    errors.depth_relative.push_back(wrong / truth.depth);
    errors.depth_ulps.push_back(wrong / (unit * size));
    errors.normal_degrees.push_back(nearest_angle(truth.normals, deepest.normal));
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

void add_pairs(PairErrors& sum, const PairErrors& term) {
    sum.candidates += term.candidates;
    sum.disjoint += term.disjoint;
    sum.touching += term.touching;
    sum.overlapping += term.overlapping;
    sum.invalid += term.invalid;
    sum.missed_touching += term.missed_touching;
    sum.missed_overlapping += term.missed_overlapping;
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
    add_pairs(pairs, other.pairs);
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
    if (other.contacts) {
        if (!contacts) contacts.emplace();
        contacts->add(*other.contacts);
    }
}

DecisionMatrix decision_matrix(const FrameTruth& truth, std::span<const Pair> candidates,
                               std::span<const ContactPoint> contacts) {
    DecisionMatrix matrix{};
    std::size_t next = 0;
    const auto count_row = [&](unsigned row, const std::vector<Pair>& pairs) {
        for (const auto& pair : pairs) ++matrix[row][answered(contacts_of(contacts, pair))];
    };
    count_row(1, truth.touching);
    count_row(2, truth.overlapping);
    for (const auto& pair : candidates) {
        while (next < contacts.size() && contacts[next].pair < pair) ++next;
        auto end = next;
        while (end < contacts.size() && contacts[end].pair == pair) ++end;
        const bool meets = std::binary_search(truth.touching.begin(), truth.touching.end(), pair)
                           || std::binary_search(truth.overlapping.begin(), truth.overlapping.end(), pair);
        if (!meets) ++matrix[0][answered(contacts.subspan(next, end - next))];
        next = end;
    }
    return matrix;
}

ContactTruths contact_truths(const Scene& scene, const Frame& frame, Precision precision,
                             const FrameTruth& truth, std::size_t most) {
    ContactTruths result;
    const auto& all = truth.overlapping;
    const auto count = most == 0 ? all.size() : std::min(most, all.size());
    result.every = count == all.size();
    std::vector<Pair> chosen;
    for (std::size_t i = 0; i < count; ++i) chosen.push_back(all[i * all.size() / count]);
    const auto corners = pair_corners(scene, frame, precision, chosen);
    std::vector<std::optional<ContactTruth>> truths(chosen.size());
    parallel_for(chosen.size(),
                 [&](std::size_t i) { truths[i] = contact_truth(corners[i][0], corners[i][1]); });
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (!truths[i]) continue; // no volume: no depth to compare with
        result.pairs.push_back(chosen[i]);
        result.truths.push_back(std::move(*truths[i]));
        result.sizes.push_back(std::max(longest_edge(corners[i][0]), longest_edge(corners[i][1])));
    }
    return result;
}

ContactErrors contact_errors(const ContactTruths& truths, std::span<const ContactPoint> contacts,
                             double unit) {
    constexpr std::size_t part = 256;
    std::vector<ContactErrors> parts((truths.pairs.size() + part - 1) / part);
    parallel_for(parts.size(), [&](std::size_t index) {
        const auto end = std::min(truths.pairs.size(), (index + 1) * part);
        for (auto i = index * part; i < end; ++i)
            compare(truths.truths[i], truths.sizes[i], contacts_of(contacts, truths.pairs[i]), unit,
                    parts[index]);
    });
    ContactErrors errors;
    for (const auto& one : parts) errors.add(one);
    return errors;
}

std::optional<Spread> spread(std::vector<double> samples) {
    if (samples.empty()) return std::nullopt;
    std::sort(samples.begin(), samples.end());
    const auto at = [&](double share) {
        const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(samples.size())));
        return samples[std::max<std::size_t>(rank, 1) - 1];
    };
    return Spread{at(0.5), at(0.99), samples.back()};
}

} // namespace tandem
