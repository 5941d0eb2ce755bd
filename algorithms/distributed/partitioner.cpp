// SPDX-License-Identifier: MIT
#include "algorithms/distributed/partitioner.h"

#include "algorithms/orders/order.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <numeric>
#include <utility>

namespace tandem {

namespace {

/// Work for one candidate pair, walk and contacts, in refitted tetrahedra. Measured: 2,000 jacks on an H200.
constexpr double work_of_a_pair = 6;

/// Volume of the intersection of two balls.
double common_volume(double a, double b, double distance) {
    if (distance >= a + b) return 0;
    const double least = std::min(a, b);
    if (distance <= std::abs(a - b)) return 4 * std::numbers::pi / 3 * least * least * least;
    const double depth = a + b - distance;
    return std::numbers::pi * depth * depth
           * (distance * distance + 2 * distance * (a + b) - 3 * (a - b) * (a - b)) / (12 * distance);
}

} // namespace

Partitioner::Partitioner(const Scene& scene, const Geometry& geometry, std::size_t subdomains)
    : scene_(scene),
      sweep_(scene, geometry, Broad::tight),
      tracker_(scene),
      all_bodies_(scene.bodies.size()),
      subdomains_(subdomains),
      balls_(scene.bodies.size()),
      rows_(scene.bodies.size()),
      owners_(scene.bodies.size(), subdomains),
      calibration_(scene.bodies.size(), 1.0) {
    std::iota(all_bodies_.begin(), all_bodies_.end(), 0u);
}

bool Partitioner::is_valid(const FrameInput& input) {
    is_expired_ = !is_partitioned_ || (!has_all_ghosts_ && !tracker_.all_within(input, all_bodies_, skin_));
    valid_frames_ += is_expired_ ? 0 : 1;
    return !is_expired_;
}

void Partitioner::order_bodies() {
    std::vector<Eigen::Vector3d> centres;
    std::vector<std::uint32_t> moving, fixed;
    for (const auto body : all_bodies_) {
        (scene_.bodies[body].fixed ? fixed : moving).push_back(body);
        if (!scene_.bodies[body].fixed) centres.push_back(balls_[body].centre);
    }
    moving_ = moving.size();
    order_.clear();
    for (const auto position : hilbert_order(centres)) order_.push_back(moving[position]);
    order_.insert(order_.end(), fixed.begin(), fixed.end());
    for (std::uint32_t row = 0; row < order_.size(); ++row) rows_[order_[row]] = row;
}

/// Assumes that tetrahedra are distributed uniformly in the balls. Two of them form a pair when the distance
/// of their centres is below the sum of their sizes.
double Partitioner::estimated_pairs(BodyPair pair) const {
    const auto &a = balls_[pair.a], &b = balls_[pair.b];
    const double volume = common_volume(a.radius, b.radius, (a.centre - b.centre).norm());
    if (!(volume > 0)) return 0;
    const auto density = [&](const Ball& ball, std::uint32_t body) {
        return tetrahedra_of(body) / (4 * std::numbers::pi / 3 * ball.radius * ball.radius * ball.radius);
    };
    const double of_a = density(a, pair.a), of_b = density(b, pair.b);
    const double size = 1 / std::cbrt(of_a) + 1 / std::cbrt(of_b);
    return volume * of_a * of_b * size * size * size;
}

/// The work of a body is its tetrahedra, and its pairs with bodies that follow it on the curve.
void Partitioner::estimate_work() {
    constexpr std::size_t part = 1 << 14;
    estimated_pairs_.resize(pairs_.size());
    parallel_for((pairs_.size() + part - 1) / part, [&](std::size_t p) {
        for (auto i = p * part; i < std::min(pairs_.size(), (p + 1) * part); ++i)
            estimated_pairs_[i] = estimated_pairs(pairs_[i]);
    });
    work_.resize(moving_);
    for (std::size_t row = 0; row < moving_; ++row) work_[row] = tetrahedra_of(order_[row]);
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
        const auto [a, b] = pairs_[i];
        work_[std::min(rows_[a], rows_[b])] +=
            work_of_a_pair * estimated_pairs_[i] * calibration_[a] * calibration_[b];
    }
}

/// Two passes of a bucket sort. The first lists neighbours in any order. The second visits rows in ascending
/// order and appends each to the lists of its neighbours.
void Partitioner::list_neighbours() {
    starts_.assign(order_.size() + 1, 0);
    for (const auto& pair : pairs_)
        for (const auto body : {pair.a, pair.b}) ++starts_[rows_[body] + 1];
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    std::vector<std::uint32_t> unsorted(2 * pairs_.size());
    auto next = starts_;
    for (const auto& pair : pairs_) {
        unsorted[next[rows_[pair.a]]++] = rows_[pair.b];
        unsorted[next[rows_[pair.b]]++] = rows_[pair.a];
    }
    neighbours_.resize(unsorted.size());
    std::copy(starts_.begin(), starts_.end(), next.begin());
    for (std::uint32_t row = 0; row < order_.size(); ++row)
        for (auto i = starts_[row]; i < starts_[row + 1]; ++i) neighbours_[next[unsorted[i]]++] = row;
}

/// Calls visit(subdomain) for each subdomain in which the row's body is a ghost. Owners ascend along the
/// curve, so that neighbours of one subdomain are consecutive.
template<class Visit>
void Partitioner::for_ghost_subdomains(std::size_t row, const Visit& visit) const {
    auto last = subdomains_.size();
    for (auto i = starts_[row]; i < starts_[row + 1]; ++i) {
        const auto subdomain = owners_[neighbours_[i]];
        if (subdomain >= owners_[row]) return;
        if (std::exchange(last, subdomain) != subdomain) visit(subdomain);
    }
}

/// Tetrahedra of ghosts by subdomain. Sums of integers do not depend on the order of threads.
std::vector<double> Partitioner::compute_ghost_work() const {
    constexpr std::size_t part = 1 << 16;
    std::vector<double> all(subdomains_.size());
    std::mutex mutex;
    parallel_for((order_.size() + part - 1) / part, [&](std::size_t p) {
        std::vector<double> some(subdomains_.size());
        for (auto row = p * part; row < std::min(order_.size(), (p + 1) * part); ++row)
            for_ghost_subdomains(
                row, [&](std::size_t subdomain) { some[subdomain] += tetrahedra_of(order_[row]); });
        const std::lock_guard lock(mutex);
        for (std::size_t subdomain = 0; subdomain < all.size(); ++subdomain)
            all[subdomain] += some[subdomain];
    });
    return all;
}

/// Assigns each subdomain bodies along the curve up to its part of the total work, less its `ghost_work`.
/// Returns the work of own bodies by subdomain.
std::vector<double> Partitioner::cut_once(std::span<const double> speeds,
                                          std::span<const double> ghost_work) {
    const double all_work = std::accumulate(work_.begin(), work_.end(), 0.0);
    const double all_ghost_work = std::accumulate(ghost_work.begin(), ghost_work.end(), 0.0);
    const double all_speed = std::accumulate(speeds.begin(), speeds.end(), 0.0);
    const auto target = [&](std::size_t subdomain) {
        return std::max(0.0,
                        (all_work + all_ghost_work) * speeds[subdomain] / all_speed - ghost_work[subdomain]);
    };
    std::fill(owners_.begin(), owners_.end(), subdomains_.size());
    for (auto& subdomain : subdomains_) subdomain = {};
    std::vector<double> own(subdomains_.size());
    double done = 0, until = 0;
    std::size_t subdomain = 0;
    for (std::size_t i = 0; i < moving_; ++i) {
        // A body belongs to the subdomain whose part contains the middle of the body's work.
        while (subdomain + 1 < subdomains_.size() && done + work_[i] / 2 >= until + target(subdomain))
            until += target(subdomain++);
        subdomains_[subdomain].own.push_back(order_[i]);
        owners_[i] = subdomain;
        own[subdomain] += work_[i];
        done += work_[i];
    }
    return own;
}

/// Ghost work is known only after a cut, so that the cut is iterated a few times. The cut with the shortest
/// longest time of a subdomain is used.
void Partitioner::cut(std::span<const double> speeds) {
    constexpr int times = 4;
    list_neighbours();
    std::vector<double> ghost_work(subdomains_.size()), best = ghost_work;
    double shortest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < times; ++i) {
        const auto own = cut_once(speeds, ghost_work);
        const auto before = std::exchange(ghost_work, compute_ghost_work());
        double longest = 0;
        for (std::size_t subdomain = 0; subdomain < subdomains_.size(); ++subdomain)
            longest = std::max(longest, (own[subdomain] + ghost_work[subdomain]) / speeds[subdomain]);
        if (longest >= shortest) continue;
        shortest = longest;
        best = before;
    }
    cut_once(speeds, best);
    collect_ghosts();
}

/// Makes ghosts complete: the subdomain that has a pair contains both bodies of it.
void Partitioner::collect_ghosts() {
    for (auto& subdomain : subdomains_) subdomain.ghosts.clear();
    for (std::size_t row = 0; row < order_.size(); ++row)
        for_ghost_subdomains(
            row, [&](std::size_t subdomain) { subdomains_[subdomain].ghosts.push_back(order_[row]); });
    parallel_for(subdomains_.size(),
                 [&](std::size_t subdomain) { std::ranges::sort(subdomains_[subdomain].ghosts); });
}

void Partitioner::collect_all_ghosts() {
    for (auto& subdomain : subdomains_) subdomain.ghosts.clear();
    for (std::size_t i = 0; i < subdomains_.size(); ++i)
        for (const auto body : all_bodies_)
            if (owner_of(body) > i) subdomains_[i].ghosts.push_back(body);
}

void Partitioner::partition(const Frame& frame, std::span<const double> speeds) {
    const bool expired_early = is_expired_ && is_partitioned_ && valid_frames_ < min_lifetime;
    has_all_ghosts_ = has_all_ghosts_ || (expired_early && skin_ >= largest_skin);
    if (expired_early) skin_ = std::min(2 * skin_, largest_skin);
    valid_frames_ = 0;
    is_partitioned_ = true;
    tracker_.set_reference(frame, all_bodies_);
    for (const auto body : all_bodies_) balls_[body] = tracker_.ball(body);
    order_bodies();
    pairs_ = sweep_.pairs(frame, tracker_.skins(skin_));
    estimate_work();
    cut(speeds);
    if (has_all_ghosts_) collect_all_ghosts();
    count_tetrahedra();
}

void Partitioner::partition(std::span<const Ball> balls, std::span<const double> speeds) {
    balls_.assign(balls.begin(), balls.end());
    order_bodies();
    pairs_ = sweep_.pairs(balls);
    estimate_work();
    cut(speeds);
    count_tetrahedra();
}

double Partitioner::tetrahedra_of(std::uint32_t body) const {
    return static_cast<double>(scene_.meshes[scene_.bodies[body].mesh].tetrahedra.size());
}

/// Once a partition, because sessions call work_of() for all subdomains in every frame.
void Partitioner::count_tetrahedra() {
    tetrahedra_.assign(subdomains_.size(), 0);
    for (std::size_t subdomain = 0; subdomain < subdomains_.size(); ++subdomain)
        for (const auto* bodies : {&subdomains_[subdomain].own, &subdomains_[subdomain].ghosts})
            for (const auto body : *bodies) tetrahedra_[subdomain] += tetrahedra_of(body);
}

double Partitioner::work_of(std::size_t subdomain, std::uint64_t pairs) const {
    return tetrahedra_[subdomain] + work_of_a_pair * static_cast<double>(pairs);
}

std::uint64_t Partitioner::expected_pairs(std::size_t subdomain) const {
    double work = 0;
    for (std::size_t row = 0; row < moving_; ++row)
        if (owners_[row] == subdomain) work += work_[row] - tetrahedra_of(order_[row]);
    return is_calibrated_ ? static_cast<std::uint64_t>(work / work_of_a_pair) : 0;
}

/// Fits the factors so that, for each body, the sum of its corrected estimates equals the pairs found:
/// iterative proportional fitting (Deming and Stephan 1940) of a symmetric table. The square root keeps the
/// two bodies of a pair from correcting the same error twice.
void Partitioner::calibrate(std::span<const std::uint64_t> pairs_by_body) {
    constexpr double least = 1e-3, most = 1e3;
    constexpr int times = 12;
    is_calibrated_ = true;
    std::vector<double> expected(calibration_.size());
    for (int i = 0; i < times; ++i) {
        std::ranges::fill(expected, 0);
        for (std::size_t pair = 0; pair < pairs_.size(); ++pair) {
            const auto [a, b] = pairs_[pair];
            const double pairs = estimated_pairs_[pair] * calibration_[a] * calibration_[b];
            expected[a] += pairs;
            expected[b] += pairs;
        }
        for (std::size_t body = 0; body < calibration_.size(); ++body)
            if (expected[body] >= 1)
                calibration_[body] = std::clamp(
                    calibration_[body] * std::sqrt(static_cast<double>(pairs_by_body[body]) / expected[body]),
                    least, most);
    }
}

} // namespace tandem
