// SPDX-License-Identifier: MIT
#include "scenes/simulate/reduce.h"

#include "base/parallel.h"
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/cells.h"

#include <algorithm>
#include <limits>

namespace tandem {

namespace {

using simulate::dot;
using simulate::PointGrid;

constexpr double same_direction = 0.99984769515639124; ///< cosine of one degree

Eigen::Vector3d point_of(const ContactPoint& c) { return {c.point[0], c.point[1], c.point[2]}; }
Eigen::Vector3d normal_of(const ContactPoint& c) { return {c.normal[0], c.normal[1], c.normal[2]}; }

double squared(const Eigen::Vector3d& v) { return dot(v, v); }

/// Merges one body pair's contacts into `kept`.
void merge(std::span<const ContactPoint> group, double radius, PointGrid& cells,
           std::vector<ContactPoint>& kept) {
    const auto first = kept.size();
    if (!(radius > 0)) {
        kept.insert(kept.end(), group.begin(), group.end());
        return;
    }
    cells.reset(point_of(group.front()), radius, group.size());
    for (const auto& contact : group) {
        const auto point = point_of(contact);
        const auto same = cells.least(point, [&](std::uint32_t other) {
            const auto& candidate = kept[first + other];
            return squared(point_of(candidate) - point) < radius * radius
                   && dot(normal_of(candidate), normal_of(contact)) > same_direction;
        });
        if (same != PointGrid::none) {
            kept[first + same].depth = std::min(kept[first + same].depth, contact.depth);
            continue;
        }
        cells.insert(point, static_cast<std::uint32_t>(kept.size() - first));
        kept.push_back(contact);
    }
}

double squared_diagonal(std::span<const ContactPoint> group) {
    Eigen::Vector3d low = point_of(group.front()), high = low;
    for (const auto& contact : group) {
        low = low.cwiseMin(point_of(contact));
        high = high.cwiseMax(point_of(contact));
    }
    return squared(high - low);
}

/// Appends `count` of one body pair's contacts to `kept`.
void choose(std::span<const ContactPoint> group, std::size_t count, std::vector<ContactPoint>& kept) {
    const double diagonal = squared_diagonal(group);
    const double per_length = diagonal > 0 ? 1 / diagonal : 0;
    std::vector<double> nearest(group.size(), std::numeric_limits<double>::max());
    std::vector<std::size_t> chosen;
    auto next = static_cast<std::size_t>(
        std::min_element(group.begin(), group.end(),
                         [](const auto& a, const auto& b) { return a.depth < b.depth; })
        - group.begin());
    while (true) {
        chosen.push_back(next);
        nearest[next] = -1;
        if (chosen.size() == count) break;
        const auto point = point_of(group[next]), normal = normal_of(group[next]);
        for (std::size_t i = 0; i < group.size(); ++i)
            nearest[i] = std::min(nearest[i], squared(point_of(group[i]) - point) * per_length
                                                  + squared(normal_of(group[i]) - normal));
        next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    }
    std::sort(chosen.begin(), chosen.end());
    for (const auto i : chosen) kept.push_back(group[i]);
}

/// Merges one body pair's contacts and selects some of them.
void reduce_group(std::span<const ContactPoint> group, double radius, std::size_t per_pair, PointGrid& cells,
                  std::vector<ContactPoint>& kept) {
    if (per_pair == 0) return merge(group, radius, cells, kept);
    std::vector<ContactPoint> merged;
    merge(group, radius, cells, merged);
    if (merged.size() > per_pair) return choose(merged, per_pair, kept);
    kept.insert(kept.end(), merged.begin(), merged.end());
}

/// Runs of contacts of the same two bodies.
std::vector<std::span<const ContactPoint>> groups_of(std::span<const ContactPoint> contacts) {
    std::vector<std::span<const ContactPoint>> groups;
    for (std::size_t begin = 0, end = 0; begin < contacts.size(); begin = end) {
        while (end < contacts.size() && contacts[end].pair.body_a == contacts[begin].pair.body_a
               && contacts[end].pair.body_b == contacts[begin].pair.body_b)
            ++end;
        groups.push_back(contacts.subspan(begin, end - begin));
    }
    return groups;
}

/// Groups contacts by body pair. The input is ordered by body_a, tet_a, body_b, tet_b; the order within a
/// body pair is kept.
std::vector<ContactPoint> by_bodies(std::span<const ContactPoint> contacts) {
    std::vector<std::pair<std::uint64_t, std::size_t>> order;
    order.reserve(contacts.size());
    for (const auto& contact : contacts)
        order.emplace_back(std::uint64_t{contact.pair.body_a} << 32 | contact.pair.body_b, order.size());
    parallel_sort(order);
    std::vector<ContactPoint> result;
    result.reserve(contacts.size());
    for (const auto& [bodies, index] : order) result.push_back(contacts[index]);
    return result;
}

} // namespace

std::vector<ContactPoint> reduce_contacts(std::span<const ContactPoint> contacts,
                                          std::span<const double> sizes, const ReductionSettings& settings) {
    const auto grouped = by_bodies(contacts);
    const auto groups = groups_of(grouped);
    constexpr std::size_t block = 16; // groups a task
    std::vector<std::vector<ContactPoint>> parts((groups.size() + block - 1) / block);
    parallel_for(parts.size(), [&](std::size_t part) {
        PointGrid cells;
        for (auto i = part * block; i < std::min(groups.size(), (part + 1) * block); ++i) {
            const auto& pair = groups[i].front().pair;
            reduce_group(groups[i], settings.distance * std::min(sizes[pair.body_a], sizes[pair.body_b]),
                         settings.per_pair, cells, parts[part]);
        }
    });
    std::vector<ContactPoint> kept;
    for (const auto& part : parts) kept.insert(kept.end(), part.begin(), part.end());
    return kept;
}

} // namespace tandem
