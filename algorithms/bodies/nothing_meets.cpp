// SPDX-License-Identifier: MIT
#include "algorithms/bodies/nothing_meets.h"

#include "algorithms/bodies/self_pairs.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <tuple>

namespace tandem {

namespace {

/// Bodies with equal filters, of which large scenes have few.
class Kinds {
public:
    explicit Kinds(const Scene& scene);
    /// Whether more than `count` pairs of bodies may meet by their groups.
    bool have_more_pairs_than(std::uint64_t count) const;
    /// Whether two bodies of the scene may meet by their groups.
    bool may_meet(std::uint32_t a, std::uint32_t b) const { return may_meet_of(kind_of_[a], kind_of_[b]); }

private:
    bool may_meet_of(std::uint32_t a, std::uint32_t b) const {
        return tandem::may_meet(two_of_each_, 2 * a, 2 * b + 1);
    }

    Scene two_of_each_; ///< has no never_meet
    std::vector<std::uint64_t> counts_;
    std::vector<std::uint32_t> kind_of_; ///< by body
};

Kinds::Kinds(const Scene& scene) {
    std::map<std::tuple<bool, std::uint32_t, std::uint32_t>, std::uint32_t> known;
    for (const auto& body : scene.bodies) {
        const auto next = static_cast<std::uint32_t>(counts_.size());
        const auto [kind, is_new] = known.try_emplace({body.fixed, body.groups, body.meets}, next);
        if (is_new) {
            two_of_each_.bodies.insert(two_of_each_.bodies.end(), 2, body);
            counts_.push_back(0);
        }
        ++counts_[kind->second];
        kind_of_.push_back(kind->second);
    }
}

bool Kinds::have_more_pairs_than(std::uint64_t count) const {
    std::uint64_t pairs = 0;
    for (std::uint32_t a = 0; a < counts_.size(); ++a)
        for (std::uint32_t b = a; b < counts_.size(); ++b) {
            if (may_meet_of(a, b))
                pairs += a == b ? counts_[a] * (counts_[a] - 1) / 2 : counts_[a] * counts_[b];
            if (pairs > count) return true;
        }
    return false;
}

bool two_bodies_of_a_world_may_meet(const Scene& scene) {
    const Kinds kinds(scene);
    auto apart = scene.never_meet;
    apart.erase(std::unique(apart.begin(), apart.end()), apart.end());
    const auto dropped = std::ranges::count_if(
        apart, [&](const auto& pair) { return pair[0] != pair[1] && kinds.may_meet(pair[0], pair[1]); });
    return kinds.have_more_pairs_than(static_cast<std::uint64_t>(dropped));
}

bool two_bodies_may_meet(const Scene& scene) {
    if (scene.world_size == 0) return two_bodies_of_a_world_may_meet(scene);
    auto next = scene.never_meet.begin();
    for (std::uint32_t first = 0; first < scene.bodies.size(); first += scene.world_size) {
        const auto end = std::min<std::size_t>(scene.bodies.size(), first + std::size_t{scene.world_size});
        Scene world;
        world.bodies.assign(scene.bodies.begin() + first,
                            scene.bodies.begin() + static_cast<std::ptrdiff_t>(end));
        for (; next != scene.never_meet.end() && (*next)[0] < end; ++next)
            if ((*next)[1] < end) world.never_meet.push_back({(*next)[0] - first, (*next)[1] - first});
        if (two_bodies_of_a_world_may_meet(world)) return true;
    }
    return false;
}

} // namespace

std::string why_nothing_meets(const Scene& scene, SelfPairs self) {
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body)
        if (meets_itself(scene, body, self)) return {};
    if (scene.bodies.empty() || two_bodies_may_meet(scene)) return {};
    if ((scene.bodies.size() == 1 || scene.world_size == 1) && self != SelfPairs::on)
        return fmt::format("there is one body, which setting self={} does not pair with itself; choose "
                           "self=on, or add a body",
                           self == SelfPairs::off ? "off" : "deformable");
    if (std::ranges::all_of(scene.bodies, &Body::fixed)) return "all bodies are fixed; let one move";
    return "groups, meets and never_meet keep all bodies apart; let two of them meet";
}

} // namespace tandem
