// SPDX-License-Identifier: MIT
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/step.h"

#include <algorithm>
#include <tuple>

namespace tandem::simulate {

namespace {

auto key(const Pair& pair, std::uint32_t feature) {
    return std::tuple(pair.body_a, pair.body_b, pair.tet_a, pair.tet_b, feature);
}

/// A world impulse in the axes of a row, whose normal may differ from the last step's. Limits it to no pull
/// and to Coulomb friction.
Eigen::Vector3d in_row_axes(const ContactRow& row, const Eigen::Vector3d& value) {
    Eigen::Vector3d result(std::max(0.0, dot(row.normal, value)), dot(row.tangent, value),
                           dot(row.binormal, value));
    const double radius = row.friction * result.x();
    const double slip = std::sqrt(result.y() * result.y() + result.z() * result.z());
    if (slip > radius) {
        result.y() *= radius / slip;
        result.z() *= radius / slip;
    }
    return result;
}

} // namespace

std::vector<Impulse> keep_impulses(const Problem& problem, std::span<const ContactPoint> contacts) {
    std::vector<Impulse> result;
    result.reserve(problem.rows.size());
    for (std::size_t i = 0; i < problem.rows.size(); ++i) {
        const auto& contact = contacts[problem.sources[i]];
        result.push_back({contact.pair, contact.feature, world(problem.rows[i], problem.rows[i].impulse)});
    }
    return result;
}

void reuse_impulses(std::span<const Impulse> impulses, double ratio, std::span<const ContactPoint> contacts,
                    Problem& problem) {
    auto next = impulses.begin();
    for (std::size_t i = 0; i < problem.rows.size(); ++i) {
        const auto& contact = contacts[problem.sources[i]];
        const auto wanted = key(contact.pair, contact.feature);
        while (next != impulses.end() && key(next->pair, next->feature) < wanted) ++next;
        if (next == impulses.end()) return;
        if (key(next->pair, next->feature) == wanted)
            problem.rows[i].impulse = in_row_axes(problem.rows[i], ratio * next->value);
    }
}

} // namespace tandem::simulate
