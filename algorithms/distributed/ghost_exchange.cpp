// SPDX-License-Identifier: MIT
#include "algorithms/distributed/ghost_exchange.h"

#include "algorithms/distributed/bytes.h"
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <limits>

namespace tandem {

namespace {

/// Bodies, neighbours on the curve, that a box goes around: larger ones let others in that meet none of them.
constexpr std::size_t in_a_box = 8;
/// Times a margin: two bodies come nearer by that, at most, until ranks meet again.
constexpr double room = 2;

/// Closed, as everywhere.
bool overlap(const double* a, const double* b, std::size_t axes) {
    for (std::size_t axis = 0; axis < 2 * axes; axis += 2)
        if (!(a[axis] <= b[axis + 1] && b[axis] <= a[axis + 1])) return false;
    return true;
}

void widen(double* box, const double* by, std::size_t axes) {
    for (std::size_t axis = 0; axis < 2 * axes; axis += 2) {
        box[axis] = std::min(box[axis], by[axis]);
        box[axis + 1] = std::max(box[axis + 1], by[axis + 1]);
    }
}

/// A box around every `many` boxes, one after the other.
std::vector<double> around(std::span<const double> boxes, std::size_t many, std::size_t axes) {
    const auto stride = 2 * axes;
    std::vector<double> larger;
    for (std::size_t i = 0; i * stride < boxes.size(); ++i) {
        const auto* box = &boxes[i * stride];
        if (i % many == 0)
            larger.insert(larger.end(), box, box + stride);
        else
            widen(&larger[larger.size() - stride], box, axes);
    }
    return larger;
}

} // namespace

GhostExchange::GhostExchange(const Scene& scene, const Geometry& geometry, Ranks& ranks)
    : scene_(scene),
      ranks_(ranks),
      sweep_(scene, geometry, Broad::tight),
      places_(scene),
      sent_(static_cast<std::size_t>(ranks.size())),
      received_(static_cast<std::size_t>(ranks.size())),
      ghost_frame_{std::vector<Pose>(scene.bodies.size()),
                   std::vector<std::vector<Eigen::Vector3d>>(scene.bodies.size())} {
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body)
        if (scene.bodies[body].fixed) fixed_.push_back(body);
}

bool GhostExchange::is_expired(const Frame& frame, Traffic& traffic) {
    const bool over = !is_built_ || !places_.all_within(frame, looked_at_, skin_);
    const auto said = std::array{std::byte{over ? std::uint8_t{1} : std::uint8_t{0}}};
    const auto all = ranks_.gather_to_all(said);
    traffic.bytes += said.size();
    ++traffic.messages;
    const bool any = std::ranges::any_of(all, [](const auto& one) { return one.front() != std::byte{0}; });
    if (any && is_built_ && held_ < short_lived) skin_ = std::min(2 * skin_, largest_skin);
    held_ = any ? 0 : held_ + 1;
    return any;
}

std::vector<double> GhostExchange::slabs_of(const Numbers& bodies, const Frame& frame, double skin) const {
    const auto stride = 2 * sweep_.axes();
    std::vector<double> slabs(bodies.size() * stride);
    parallel_for(in_parts(std::span(bodies)).size(), [&](std::size_t part) {
        const auto numbers = in_parts(std::span(bodies))[part];
        for (const auto& body : numbers)
            sweep_.bound(frame, body, skin * places_.ball(body).radius,
                         &slabs[static_cast<std::size_t>(&body - bodies.data()) * stride]);
    });
    return slabs;
}

/// Those of the bodies that meet one of the boxes: groups of boxes first, as neighbours stand together.
GhostExchange::Numbers GhostExchange::near(const Numbers& bodies, const std::vector<double>& slabs,
                                           std::span<const double> boxes) const {
    constexpr std::size_t in_a_group = 32;
    const auto axes = sweep_.axes(), stride = 2 * axes;
    const auto count = boxes.size() / stride;
    const auto groups = around(boxes, in_a_group, axes);
    std::vector<char> is_near(bodies.size());
    const auto meets = [&](const double* slab) {
        for (std::size_t group = 0; group * stride < groups.size(); ++group) {
            if (!overlap(slab, &groups[group * stride], axes)) continue;
            for (auto i = group * in_a_group; i < std::min(count, (group + 1) * in_a_group); ++i)
                if (overlap(slab, &boxes[i * stride], axes)) return true;
        }
        return false;
    };
    constexpr std::size_t part = 256;
    parallel_for((bodies.size() + part - 1) / part, [&](std::size_t p) {
        for (auto i = p * part; i < std::min(bodies.size(), (p + 1) * part); ++i)
            is_near[i] = meets(&slabs[i * stride]) ? 1 : 0;
    });
    Numbers result;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        if (is_near[i] != 0) result.push_back(bodies[i]);
    return result;
}

std::vector<Ranks::Bytes> GhostExchange::passed(const std::vector<Ranks::Bytes>& out, Traffic& traffic) {
    for (std::size_t i = 0; i < out.size(); ++i) {
        traffic.bytes += out[i].size();
        traffic.messages += out[i].empty() ? 0 : 1;
    }
    return ranks_.exchange(out);
}

/// Sends every rank a list of bodies; returns those that came.
std::vector<GhostExchange::Numbers> GhostExchange::exchange_ids(const std::vector<Numbers>& lists,
                                                                Traffic& traffic) {
    std::vector<Ranks::Bytes> out;
    out.reserve(lists.size());
    for (const auto& list : lists) out.push_back(as_message(std::span(list)));
    std::vector<Numbers> in;
    for (const auto& message : passed(out, traffic)) in.push_back(from_message<std::uint32_t>(message));
    return in;
}

/// Sends the boxes to later ranks that they may meet, as one box around all of each tells; returns what came
/// from earlier ones.
std::vector<Ranks::Bytes> GhostExchange::boxes_near(const std::vector<double>& boxes, Traffic& traffic) {
    const auto axes = sweep_.axes();
    const auto whole = around(boxes, std::max<std::size_t>(boxes.size(), 1), axes);
    const auto wholes = ranks_.gather_to_all(std::as_bytes(std::span(whole)));
    traffic.bytes += whole.size() * sizeof(double);
    ++traffic.messages;
    std::vector<Ranks::Bytes> out(wholes.size());
    for (auto i = static_cast<std::size_t>(ranks_.rank()) + 1; i < wholes.size(); ++i) {
        const auto theirs = from_message<double>(wholes[i]);
        if (!whole.empty() && !theirs.empty() && overlap(whole.data(), theirs.data(), axes))
            out[i] = as_message(std::span(boxes));
    }
    return passed(out, traffic);
}

/// Bodies that meet the narrow ones are in the share, and of the others those next that meet the wide ones.
/// Returns the first.
GhostExchange::Numbers GhostExchange::divide(const Numbers& bodies, const std::vector<double>& slabs,
                                             const std::vector<double>& narrow,
                                             const std::vector<double>& wide) {
    auto kept = near(bodies, slabs, narrow);
    subdomain_.ghosts.insert(subdomain_.ghosts.end(), kept.begin(), kept.end());
    auto one = kept.begin();
    for (const auto body : near(bodies, slabs, wide)) {
        if (one != kept.end() && *one == body)
            ++one;
        else
            next_.push_back(body);
    }
    return kept;
}

/// Boxes go around several bodies, and further than need be: of those that meet one, the ones that meet a
/// body are kept, and whoever sends them is told.
void GhostExchange::keep_near(const Frame& frame, const std::vector<double>& slabs,
                              const std::vector<double>& wide, Traffic& traffic) {
    exchange_states(frame, traffic);
    for (auto& list : received_) {
        places_.set_reference(ghost_frame_, list);
        list = divide(list, slabs_of(list, ghost_frame_, skin_), slabs, wide);
    }
    sent_ = exchange_ids(received_, traffic);
}

void GhostExchange::rebuild(const std::vector<std::uint32_t>& own, const Frame& frame, Traffic& traffic) {
    subdomain_ = {own, {}};
    next_.clear();
    looked_at_ = own;
    std::ranges::sort(looked_at_);
    places_.set_reference(frame, own);
    places_.set_reference(frame, fixed_);
    const auto slabs = slabs_of(own, frame, skin_), wide = slabs_of(own, frame, (1 + room) * skin_);
    const auto boxes = boxes_near(around(wide, in_a_box, sweep_.axes()), traffic);
    std::vector<Numbers> lists;
    lists.reserve(boxes.size());
    for (const auto& theirs : boxes) lists.push_back(near(own, slabs, from_message<double>(theirs)));
    received_ = exchange_ids(lists, traffic);
    sent_ = std::move(lists);
    keep_near(frame, slabs, wide, traffic);
    divide(fixed_, slabs_of(fixed_, frame, skin_), slabs, wide);
    is_built_ = true;
}

/// Poses or vertices of these bodies; then, where the frame skips tetrahedra, how many of each and which.
Ranks::Bytes GhostExchange::states_message(const Numbers& bodies, const Frame& frame, bool vertices) const {
    Ranks::Bytes words;
    for (const auto body : bodies) {
        if (!scene_.bodies[body].deformable)
            append(words, std::span(&frame.poses[body], 1));
        else if (vertices)
            append(words, std::span(frame.deformed[body]));
    }
    if (frame.skipped.empty()) return words;
    for (const auto body : bodies) {
        const std::uint64_t count = frame.skipped[body].size();
        append(words, std::span(&count, 1));
        append(words, std::span(frame.skipped[body]));
    }
    return words;
}

void GhostExchange::read_states(const Ranks::Bytes& words, const Numbers& bodies, bool vertices) {
    MessageReader message(words);
    for (const auto body : bodies) {
        if (!scene_.bodies[body].deformable) {
            message.read(std::span(&ghost_frame_.poses[body], 1));
        } else if (vertices) {
            auto& theirs = ghost_frame_.deformed[body];
            theirs.resize(scene_.meshes[scene_.bodies[body].mesh].vertices.size());
            message.read(std::span(theirs));
        }
    }
    if (message.is_at_end() && ghost_frame_.skipped.empty()) return;
    ghost_frame_.skipped.resize(scene_.bodies.size());
    for (const auto body : bodies) {
        auto& skipped = ghost_frame_.skipped[body];
        skipped.resize(message.is_at_end() ? 0 : message.read<std::uint64_t>());
        message.read(std::span(skipped));
    }
}

void GhostExchange::exchange_states(const Frame& frame, Traffic& traffic, bool vertices) {
    std::vector<Ranks::Bytes> out;
    for (const auto& bodies : sent_) out.push_back(states_message(bodies, frame, vertices));
    const auto in = passed(out, traffic);
    for (std::size_t i = 0; i < in.size(); ++i) read_states(in[i], received_[i], vertices);
}

std::vector<GhostExchange::Numbers> GhostExchange::deformable(const std::vector<Numbers>& lists) const {
    auto some = lists;
    for (auto& bodies : some)
        std::erase_if(bodies, [this](std::uint32_t body) { return !scene_.bodies[body].deformable; });
    return some;
}

} // namespace tandem
