// SPDX-License-Identifier: MIT
#include "algorithms/distributed/ghost_exchange.h"

#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <limits>

namespace tandem {

namespace {

/// Consecutive bodies on the curve that have one box. Larger boxes select bodies that overlap none of them.
constexpr std::size_t bodies_per_box = 8;
/// Skins by which a wide bound exceeds a narrow one: two bodies approach by at most that before a rebuild().
constexpr double approach = 2;

/// Closed overlap: touching overlaps.
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

/// One box for each `count` consecutive boxes, which it encloses.
std::vector<double> enclosing_boxes(std::span<const double> boxes, std::size_t count, std::size_t axes) {
    const auto stride = 2 * axes;
    std::vector<double> larger;
    for (std::size_t i = 0; i * stride < boxes.size(); ++i) {
        const auto* box = &boxes[i * stride];
        if (i % count == 0)
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
      tracker_(scene),
      sent_(static_cast<std::size_t>(ranks.size())),
      received_(static_cast<std::size_t>(ranks.size())),
      ghost_frame_{std::vector<Pose>(scene.bodies.size()),
                   std::vector<std::vector<Eigen::Vector3d>>(scene.bodies.size())},
      next_ghost_frame_(ghost_frame_) {
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body)
        if (scene.bodies[body].fixed) fixed_.push_back(body);
}

bool GhostExchange::is_expired(const FrameInput& input, Traffic& traffic) {
    const bool is_expired_locally = !is_built_ || !tracker_.all_within(input, sorted_own_, skin_);
    const auto message = std::array{std::byte{is_expired_locally ? std::uint8_t{1} : std::uint8_t{0}}};
    const auto all = ranks_.gather_to_all(message);
    traffic.bytes += message.size();
    ++traffic.messages;
    const bool any = std::ranges::any_of(all, [](const auto& one) { return one.front() != std::byte{0}; });
    if (any && is_built_ && valid_frames_ < min_lifetime) skin_ = std::min(2 * skin_, largest_skin);
    valid_frames_ = any ? 0 : valid_frames_ + 1;
    return any;
}

std::vector<double> GhostExchange::slabs_of(const BodyIds& bodies, const FrameInput& input,
                                            double skin) const {
    const auto stride = 2 * sweep_.axes();
    std::vector<double> slabs(bodies.size() * stride);
    parallel_for(in_parts(std::span(bodies)).size(), [&](std::size_t part) {
        const auto numbers = in_parts(std::span(bodies))[part];
        for (const auto& body : numbers)
            sweep_.bound(input, body, skin * tracker_.ball(body).radius,
                         &slabs[static_cast<std::size_t>(&body - bodies.data()) * stride]);
    });
    return slabs;
}

/// The bodies that overlap one of the boxes. Groups of consecutive boxes, which are neighbours, are tested
/// first.
GhostExchange::BodyIds GhostExchange::overlapping_any(const BodyIds& bodies, const std::vector<double>& slabs,
                                                      std::span<const double> boxes) const {
    constexpr std::size_t boxes_per_group = 32;
    const auto axes = sweep_.axes(), stride = 2 * axes;
    const auto count = boxes.size() / stride;
    const auto groups = enclosing_boxes(boxes, boxes_per_group, axes);
    std::vector<char> is_overlapping(bodies.size());
    const auto overlaps_box = [&](const double* slab) {
        for (std::size_t group = 0; group * stride < groups.size(); ++group) {
            if (!overlap(slab, &groups[group * stride], axes)) continue;
            for (auto i = group * boxes_per_group; i < std::min(count, (group + 1) * boxes_per_group); ++i)
                if (overlap(slab, &boxes[i * stride], axes)) return true;
        }
        return false;
    };
    constexpr std::size_t part = 256;
    parallel_for((bodies.size() + part - 1) / part, [&](std::size_t p) {
        for (auto i = p * part; i < std::min(bodies.size(), (p + 1) * part); ++i)
            is_overlapping[i] = overlaps_box(&slabs[i * stride]) ? 1 : 0;
    });
    BodyIds result;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        if (is_overlapping[i] != 0) result.push_back(bodies[i]);
    return result;
}

std::vector<Ranks::Bytes> GhostExchange::exchange_messages(const std::vector<Ranks::Bytes>& out,
                                                           Traffic& traffic) {
    for (std::size_t i = 0; i < out.size(); ++i) {
        traffic.bytes += out[i].size();
        traffic.messages += out[i].empty() ? 0 : 1;
    }
    return ranks_.exchange(out);
}

/// Sends every rank a list of bodies. Returns the received lists, by rank.
std::vector<GhostExchange::BodyIds> GhostExchange::exchange_ids(const std::vector<BodyIds>& lists,
                                                                Traffic& traffic) {
    std::vector<Ranks::Bytes> out;
    out.reserve(lists.size());
    for (const auto& list : lists) out.push_back(as_message(std::span(list)));
    std::vector<BodyIds> in;
    for (const auto& message : exchange_messages(out, traffic))
        in.push_back(from_message<std::uint32_t>(message));
    return in;
}

/// Sends the boxes to the later ranks whose bodies they may overlap, according to one box around all bodies
/// of each rank. Returns the boxes received from earlier ranks.
std::vector<Ranks::Bytes> GhostExchange::exchange_boxes(const std::vector<double>& boxes, Traffic& traffic) {
    const auto axes = sweep_.axes();
    const auto whole = enclosing_boxes(boxes, std::max<std::size_t>(boxes.size(), 1), axes);
    const auto all_whole = ranks_.gather_to_all(std::as_bytes(std::span(whole)));
    traffic.bytes += whole.size() * sizeof(double);
    ++traffic.messages;
    std::vector<Ranks::Bytes> out(all_whole.size());
    for (auto i = static_cast<std::size_t>(ranks_.rank()) + 1; i < all_whole.size(); ++i) {
        const auto remote = from_message<double>(all_whole[i]);
        if (!whole.empty() && !remote.empty() && overlap(whole.data(), remote.data(), axes))
            out[i] = as_message(std::span(boxes));
    }
    return exchange_messages(out, traffic);
}

/// Adds bodies that overlap the narrow bounds to the ghosts, and further bodies that overlap the wide bounds
/// to the next ghosts. Returns the former.
GhostExchange::BodyIds GhostExchange::select_ghosts(const BodyIds& bodies, const std::vector<double>& slabs,
                                                    const std::vector<double>& narrow,
                                                    const std::vector<double>& wide) {
    auto kept = overlapping_any(bodies, slabs, narrow);
    subdomain_.ghosts.insert(subdomain_.ghosts.end(), kept.begin(), kept.end());
    auto it = kept.begin();
    for (const auto body : overlapping_any(bodies, slabs, wide)) {
        if (it != kept.end() && *it == body)
            ++it;
        else
            next_.push_back(body);
    }
    return kept;
}

/// Boxes enclose several bodies and use wide bounds. This keeps the received bodies that overlap the bounds
/// of an own body, and sends the shorter lists back to the owners.
void GhostExchange::select_received(const FrameInput& input, const std::vector<double>& slabs,
                                    const std::vector<double>& wide, Traffic& traffic) {
    exchange_states(input, traffic);
    for (auto& list : received_) {
        tracker_.set_reference(ghost_frame_, list);
        list = select_ghosts(list, slabs_of(list, ghost_input(input), skin_), slabs, wide);
    }
    sent_ = exchange_ids(received_, traffic);
}

void GhostExchange::rebuild(const std::vector<std::uint32_t>& own, const FrameInput& input,
                            Traffic& traffic) {
    subdomain_ = {own, {}};
    next_.clear();
    sorted_own_ = own;
    std::ranges::sort(sorted_own_);
    tracker_.set_reference(input.frame, own);
    tracker_.set_reference(input.frame, fixed_);
    const auto slabs = slabs_of(own, input, skin_), wide = slabs_of(own, input, (1 + approach) * skin_);
    const auto boxes = exchange_boxes(enclosing_boxes(wide, bodies_per_box, sweep_.axes()), traffic);
    std::vector<BodyIds> lists;
    lists.reserve(boxes.size());
    for (const auto& remote : boxes)
        lists.push_back(overlapping_any(own, slabs, from_message<double>(remote)));
    received_ = exchange_ids(lists, traffic);
    sent_ = std::move(lists);
    select_received(input, slabs, wide, traffic);
    select_ghosts(fixed_, slabs_of(fixed_, input, skin_), slabs, wide);
    is_built_ = true;
}

void GhostExchange::append_states(Ranks::Bytes& message, const BodyIds& bodies, const Frame& frame,
                                  bool vertices) const {
    for (const auto body : bodies) {
        if (!scene_.bodies[body].deformable)
            append(message, std::span(&frame.poses[body], 1));
        else if (vertices)
            append(message, std::span(frame.deformed[body]));
    }
}

/// Poses or vertices of these bodies, and those of the successor. If the frame skips tetrahedra, their number
/// and list follow, by body.
Ranks::Bytes GhostExchange::states_message(const BodyIds& bodies, const FrameInput& input,
                                           bool vertices) const {
    Ranks::Bytes message;
    append_states(message, bodies, input.frame, vertices);
    if (input.next != nullptr) append_states(message, bodies, *input.next, vertices);
    if (input.frame.skipped.empty()) return message;
    for (const auto body : bodies) {
        const std::uint64_t count = input.frame.skipped[body].size();
        append(message, std::span(&count, 1));
        append(message, std::span(input.frame.skipped[body]));
    }
    return message;
}

void GhostExchange::read_states(MessageReader& reader, const BodyIds& bodies, Frame& frame,
                                bool vertices) const {
    for (const auto body : bodies) {
        if (!scene_.bodies[body].deformable) {
            reader.read(std::span(&frame.poses[body], 1));
        } else if (vertices) {
            auto& received = frame.deformed[body];
            received.resize(scene_.meshes[scene_.bodies[body].mesh].vertices.size());
            reader.read(std::span(received));
        }
    }
}

void GhostExchange::read_message(const Ranks::Bytes& message, const BodyIds& bodies, bool has_next,
                                 bool vertices) {
    MessageReader reader(message);
    read_states(reader, bodies, ghost_frame_, vertices);
    if (has_next) read_states(reader, bodies, next_ghost_frame_, vertices);
    if (reader.is_at_end() && ghost_frame_.skipped.empty()) return;
    ghost_frame_.skipped.resize(scene_.bodies.size());
    for (const auto body : bodies) {
        auto& skipped = ghost_frame_.skipped[body];
        skipped.resize(reader.is_at_end() ? 0 : reader.read<std::uint64_t>());
        reader.read(std::span(skipped));
    }
}

void GhostExchange::exchange_states(const FrameInput& input, Traffic& traffic, bool vertices) {
    std::vector<Ranks::Bytes> out;
    for (const auto& bodies : sent_) out.push_back(states_message(bodies, input, vertices));
    const auto in = exchange_messages(out, traffic);
    for (std::size_t i = 0; i < in.size(); ++i)
        read_message(in[i], received_[i], input.next != nullptr, vertices);
}

std::vector<GhostExchange::BodyIds> GhostExchange::deformable(const std::vector<BodyIds>& lists) const {
    auto result = lists;
    for (auto& bodies : result)
        std::erase_if(bodies, [this](std::uint32_t body) { return !scene_.bodies[body].deformable; });
    return result;
}

} // namespace tandem
