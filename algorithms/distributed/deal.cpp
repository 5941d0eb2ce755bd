// SPDX-License-Identifier: MIT
#include "algorithms/distributed/deal.h"

#include "algorithms/hierarchy/order.h"
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

/// Of a candidate pair, walked and made contacts of, in tetrahedra refitted: 2,000 jacks on an H200.
constexpr double work_of_a_pair = 6;

/// Volume of what two balls have in common.
double common_volume(double a, double b, double distance) {
    if (distance >= a + b) return 0;
    const double least = std::min(a, b);
    if (distance <= std::abs(a - b)) return 4 * std::numbers::pi / 3 * least * least * least;
    const double depth = a + b - distance;
    return std::numbers::pi * depth * depth
           * (distance * distance + 2 * distance * (a + b) - 3 * (a - b) * (a - b)) / (12 * distance);
}

} // namespace

Deal::Deal(const Scene& scene, const Geometry& geometry, std::size_t shares)
    : scene_(scene),
      sweep_(scene, geometry, Broad::tight),
      places_(scene),
      all_(scene.bodies.size()),
      shares_(shares),
      balls_(scene.bodies.size()),
      rows_(scene.bodies.size()),
      owners_(scene.bodies.size(), shares),
      learned_(scene.bodies.size(), 1.0) {
    std::iota(all_.begin(), all_.end(), 0u);
}

bool Deal::holds(const Frame& frame) {
    is_over_ = !is_made_ || (!has_all_ && !places_.all_within(frame, all_, margin_));
    held_ += is_over_ ? 0 : 1;
    return !is_over_;
}

void Deal::order_bodies() {
    std::vector<Eigen::Vector3d> centres;
    std::vector<std::uint32_t> moving, fixed;
    for (const auto body : all_) {
        (scene_.bodies[body].fixed ? fixed : moving).push_back(body);
        if (!scene_.bodies[body].fixed) centres.push_back(balls_[body].centre);
    }
    moving_ = moving.size();
    order_.clear();
    for (const auto position : hilbert_order(centres)) order_.push_back(moving[position]);
    order_.insert(order_.end(), fixed.begin(), fixed.end());
    for (std::uint32_t row = 0; row < order_.size(); ++row) rows_[order_[row]] = row;
}

/// As if tetrahedra were strewn evenly through the balls: those of one whose middle lies within the sum of
/// both sizes of a tetrahedron of the other.
double Deal::foreseen_pairs(BodyPair pair) const {
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

/// A body brings its share its own tetrahedra and the pairs with those that follow it on the curve.
void Deal::expect_work() {
    constexpr std::size_t part = 1 << 14;
    foreseen_.resize(near_.size());
    parallel_for((near_.size() + part - 1) / part, [&](std::size_t p) {
        for (auto i = p * part; i < std::min(near_.size(), (p + 1) * part); ++i)
            foreseen_[i] = foreseen_pairs(near_[i]);
    });
    work_.resize(moving_);
    for (std::size_t row = 0; row < moving_; ++row) work_[row] = tetrahedra_of(order_[row]);
    for (std::size_t i = 0; i < near_.size(); ++i) {
        const auto [a, b] = near_[i];
        work_[std::min(rows_[a], rows_[b])] += work_of_a_pair * foreseen_[i] * learned_[a] * learned_[b];
    }
}

/// In two passes over all pairs: rows in any order, then each row's neighbours told of it in the rows' order.
void Deal::list_neighbours() {
    first_.assign(order_.size() + 1, 0);
    for (const auto& pair : near_)
        for (const auto body : {pair.a, pair.b}) ++first_[rows_[body] + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> unsorted(2 * near_.size());
    auto next = first_;
    for (const auto& pair : near_) {
        unsorted[next[rows_[pair.a]]++] = rows_[pair.b];
        unsorted[next[rows_[pair.b]]++] = rows_[pair.a];
    }
    neighbours_.resize(unsorted.size());
    std::copy(first_.begin(), first_.end(), next.begin());
    for (std::uint32_t row = 0; row < order_.size(); ++row)
        for (auto i = first_[row]; i < first_[row + 1]; ++i) neighbours_[next[unsorted[i]]++] = row;
}

/// Calls need(share) for each share that has a pair of the row's body and does not own it. Owners do not fall
/// along the curve, so that a share's neighbours stand together.
template<class Need>
void Deal::for_needs(std::size_t row, const Need& need) const {
    auto last = shares_.size();
    for (auto i = first_[row]; i < first_[row + 1]; ++i) {
        const auto share = owners_[neighbours_[i]];
        if (share >= owners_[row]) return;
        if (std::exchange(last, share) != share) need(share);
    }
}

/// By share: tetrahedra of others' bodies that it needs. Sums of whole numbers, the same in any order.
std::vector<double> Deal::brought() const {
    constexpr std::size_t part = 1 << 16;
    std::vector<double> all(shares_.size());
    std::mutex mutex;
    parallel_for((order_.size() + part - 1) / part, [&](std::size_t p) {
        std::vector<double> some(shares_.size());
        for (auto row = p * part; row < std::min(order_.size(), (p + 1) * part); ++row)
            for_needs(row, [&](std::size_t share) { some[share] += tetrahedra_of(order_[row]); });
        const std::lock_guard lock(mutex);
        for (std::size_t share = 0; share < all.size(); ++share) all[share] += some[share];
    });
    return all;
}

/// Each share takes bodies up to where its part of all work ends, which is less by what others' bodies
/// `brought` it. Returns the work of its own bodies.
std::vector<double> Deal::cut_once(std::span<const double> speeds, std::span<const double> brought) {
    const double all_work = std::accumulate(work_.begin(), work_.end(), 0.0);
    const double all_brought = std::accumulate(brought.begin(), brought.end(), 0.0);
    const double all_speed = std::accumulate(speeds.begin(), speeds.end(), 0.0);
    const auto part = [&](std::size_t share) {
        return std::max(0.0, (all_work + all_brought) * speeds[share] / all_speed - brought[share]);
    };
    std::fill(owners_.begin(), owners_.end(), shares_.size());
    for (auto& share : shares_) share = {};
    std::vector<double> own(shares_.size());
    double done = 0, until = 0;
    std::size_t share = 0;
    for (std::size_t i = 0; i < moving_; ++i) {
        // A body goes to the share in whose part the middle of its work lies.
        while (share + 1 < shares_.size() && done + work_[i] / 2 >= until + part(share))
            until += part(share++);
        shares_[share].own.push_back(order_[i]);
        owners_[i] = share;
        own[share] += work_[i];
        done += work_[i];
    }
    return own;
}

/// What others' bodies bring a share is known once it is cut: a few times, and the cut stays in which the
/// share that takes longest is done first.
void Deal::cut(std::span<const double> speeds) {
    constexpr int times = 4;
    list_neighbours();
    std::vector<double> foreign(shares_.size()), best = foreign;
    double shortest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < times; ++i) {
        const auto own = cut_once(speeds, foreign);
        const auto before = std::exchange(foreign, brought());
        double longest = 0;
        for (std::size_t share = 0; share < shares_.size(); ++share)
            longest = std::max(longest, (own[share] + foreign[share]) / speeds[share]);
        if (longest >= shortest) continue;
        shortest = longest;
        best = before;
    }
    cut_once(speeds, best);
    gather();
}

/// Of every pair the share that has it needs both.
void Deal::gather() {
    for (auto& share : shares_) share.others.clear();
    for (std::size_t row = 0; row < order_.size(); ++row)
        for_needs(row, [&](std::size_t share) { shares_[share].others.push_back(order_[row]); });
    parallel_for(shares_.size(), [&](std::size_t share) { std::ranges::sort(shares_[share].others); });
}

void Deal::gather_all() {
    for (auto& share : shares_) share.others.clear();
    for (std::size_t i = 0; i < shares_.size(); ++i)
        for (const auto body : all_)
            if (owner_of(body) > i) shares_[i].others.push_back(body);
}

void Deal::make(const Frame& frame, std::span<const double> speeds) {
    const bool too_soon = is_over_ && is_made_ && held_ < soon;
    has_all_ = has_all_ || (too_soon && margin_ >= most_margin);
    if (too_soon) margin_ = std::min(2 * margin_, most_margin);
    held_ = 0;
    is_made_ = true;
    places_.keep(frame, all_);
    for (const auto body : all_) balls_[body] = places_.ball(body);
    order_bodies();
    near_ = sweep_.pairs(frame, places_.margins(margin_));
    expect_work();
    cut(speeds);
    if (has_all_) gather_all();
    count_tetrahedra();
}

void Deal::make(std::span<const Ball> balls, std::span<const double> speeds) {
    balls_.assign(balls.begin(), balls.end());
    order_bodies();
    near_ = sweep_.pairs(balls);
    expect_work();
    cut(speeds);
    count_tetrahedra();
}

double Deal::tetrahedra_of(std::uint32_t body) const {
    return static_cast<double>(scene_.meshes[scene_.bodies[body].mesh].tetrahedra.size());
}

/// Once a deal: who shares frames asks for the work of all shares in every one.
void Deal::count_tetrahedra() {
    tetrahedra_.assign(shares_.size(), 0);
    for (std::size_t share = 0; share < shares_.size(); ++share)
        for (const auto* bodies : {&shares_[share].own, &shares_[share].others})
            for (const auto body : *bodies) tetrahedra_[share] += tetrahedra_of(body);
}

double Deal::work_of(std::size_t share, std::uint64_t pairs) const {
    return tetrahedra_[share] + work_of_a_pair * static_cast<double>(pairs);
}

std::uint64_t Deal::expected_pairs(std::size_t share) const {
    double work = 0;
    for (std::size_t row = 0; row < moving_; ++row)
        if (owners_[row] == share) work += work_[row] - tetrahedra_of(order_[row]);
    return has_learned_ ? static_cast<std::uint64_t>(work / work_of_a_pair) : 0;
}

/// Sums of the pairs foreseen, times their bodies' numbers, are made those that were found, body by body, a
/// few times over: iterative proportional fitting (Deming and Stephan 1940) of a symmetric table, whose roots
/// keep both bodies of a pair from mending the same error.
void Deal::learn(std::span<const std::uint64_t> pairs_by_body) {
    constexpr double least = 1e-3, most = 1e3;
    constexpr int times = 12;
    has_learned_ = true;
    std::vector<double> expected(learned_.size());
    for (int i = 0; i < times; ++i) {
        std::ranges::fill(expected, 0);
        for (std::size_t pair = 0; pair < near_.size(); ++pair) {
            const auto [a, b] = near_[pair];
            const double pairs = foreseen_[pair] * learned_[a] * learned_[b];
            expected[a] += pairs;
            expected[b] += pairs;
        }
        for (std::size_t body = 0; body < learned_.size(); ++body)
            if (expected[body] >= 1)
                learned_[body] = std::clamp(
                    learned_[body] * std::sqrt(static_cast<double>(pairs_by_body[body]) / expected[body]),
                    least, most);
    }
}

} // namespace tandem
