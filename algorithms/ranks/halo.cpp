// SPDX-License-Identifier: MIT
#include "algorithms/ranks/halo.h"

#include "algorithms/ranks/bytes.h"
#include "scenes/parallel.h"

#include <algorithm>
#include <atomic>
#include <limits>

namespace tandem {

namespace {

/// Bodies, neighbours on the curve, that a box goes around: larger ones let others in that meet none of them.
constexpr std::size_t in_a_box = 8;
constexpr double most_margin = 2; ///< of a radius
constexpr std::size_t soon = 8;   ///< frames: less make margins grow

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

} // namespace

Halo::Halo(const Scene& scene, const Geometry& geometry, Ranks& ranks)
    : scene_(scene),
      ranks_(ranks),
      sweep_(scene, geometry, Broad::tight),
      places_(scene),
      sent_(static_cast<std::size_t>(ranks.size())),
      gotten_(static_cast<std::size_t>(ranks.size())) {
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body)
        if (scene.bodies[body].fixed) fixed_.push_back(body);
}

bool Halo::is_over(const Frame& frame, Traffic& traffic) {
    const bool over = !is_met_ || !places_.all_within(frame, share_.own, margin_);
    const auto said = std::array{std::byte{over ? std::uint8_t{1} : std::uint8_t{0}}};
    const auto all = ranks_.gather_to_all(said);
    traffic.bytes += said.size();
    ++traffic.messages;
    const bool any = std::ranges::any_of(all, [](const auto& one) { return one.front() != std::byte{0}; });
    if (any && is_met_ && held_ < soon) margin_ = std::min(2 * margin_, most_margin);
    held_ = any ? 0 : held_ + 1;
    return any;
}

std::vector<double> Halo::slabs_of(const Numbers& bodies, const Frame& frame) const {
    const auto stride = 2 * sweep_.axes();
    std::vector<double> slabs(bodies.size() * stride);
    parallel_for(in_parts(std::span(bodies)).size(), [&](std::size_t part) {
        const auto numbers = in_parts(std::span(bodies))[part];
        for (const auto& body : numbers)
            sweep_.bound(frame, body, margin_ * places_.ball(body).radius,
                         &slabs[static_cast<std::size_t>(&body - bodies.data()) * stride]);
    });
    return slabs;
}

/// A box around every so many bodies, one after the other.
std::vector<double> Halo::boxes_over(const std::vector<double>& slabs) const {
    const auto stride = 2 * sweep_.axes();
    std::vector<double> boxes;
    for (std::size_t i = 0; i < slabs.size() / stride; ++i) {
        if (i % in_a_box == 0)
            boxes.insert(boxes.end(), slabs.begin() + static_cast<std::ptrdiff_t>(i * stride),
                         slabs.begin() + static_cast<std::ptrdiff_t>((i + 1) * stride));
        else
            widen(&boxes[boxes.size() - stride], &slabs[i * stride], sweep_.axes());
    }
    return boxes;
}

/// Those of the bodies that meet one of the boxes: groups of boxes first, as neighbours stand together.
Halo::Numbers Halo::near(const Numbers& bodies, const std::vector<double>& slabs,
                         std::span<const double> boxes) const {
    constexpr std::size_t in_a_group = 32;
    const auto axes = sweep_.axes(), stride = 2 * axes;
    const auto count = boxes.size() / stride;
    std::vector<double> groups;
    for (std::size_t i = 0; i < count; ++i) {
        const auto* box = &boxes[i * stride];
        if (i % in_a_group == 0)
            groups.insert(groups.end(), box, box + stride);
        else
            widen(&groups[groups.size() - stride], box, axes);
    }
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

std::vector<Ranks::Bytes> Halo::passed(const std::vector<Ranks::Bytes>& out, Traffic& traffic) {
    for (std::size_t i = 0; i < out.size(); ++i) {
        traffic.bytes += out[i].size();
        traffic.messages += out[i].empty() ? 0 : 1;
    }
    return ranks_.exchange(out);
}

/// Sends every rank a list of bodies; returns those that came.
std::vector<Halo::Numbers> Halo::told(const std::vector<Numbers>& lists, Traffic& traffic) {
    std::vector<Ranks::Bytes> out;
    for (const auto& list : lists) out.push_back(as_message(std::span(list)));
    std::vector<Numbers> in;
    for (const auto& message : passed(out, traffic)) in.push_back(from_message<std::uint32_t>(message));
    return in;
}

/// Boxes go around several bodies: of those that meet one, the ones that meet a body are kept, and whoever
/// sends them is told.
void Halo::keep_near(const Frame& frame, const std::vector<double>& slabs, Traffic& traffic) {
    Frame known = frame;
    trade(known, traffic);
    for (auto& list : gotten_) {
        places_.keep(known, list);
        list = near(list, slabs_of(list, known), slabs);
        share_.others.insert(share_.others.end(), list.begin(), list.end());
    }
    sent_ = told(gotten_, traffic);
}

void Halo::meet(const std::vector<std::uint32_t>& own, const Frame& frame, Traffic& traffic) {
    share_ = {own, {}};
    places_.keep(frame, own);
    places_.keep(frame, fixed_);
    const auto slabs = slabs_of(own, frame);
    const auto boxes = boxes_over(slabs);
    const auto all = ranks_.gather_to_all(std::as_bytes(std::span(boxes)));
    traffic.bytes += boxes.size() * sizeof(double);
    ++traffic.messages;
    std::vector<Numbers> lists(all.size());
    for (std::size_t i = 0; i < static_cast<std::size_t>(ranks_.rank()); ++i)
        lists[i] = near(own, slabs, from_message<double>(all[i]));
    gotten_ = told(lists, traffic);
    sent_ = std::move(lists);
    keep_near(frame, slabs, traffic);
    const auto fixed = near(fixed_, slabs_of(fixed_, frame), slabs);
    share_.others.insert(share_.others.end(), fixed.begin(), fixed.end());
    is_met_ = true;
}

void Halo::trade(Frame& frame, Traffic& traffic) {
    std::vector<Ranks::Bytes> out(sent_.size());
    for (std::size_t i = 0; i < sent_.size(); ++i)
        for (const auto body : sent_[i]) {
            if (scene_.bodies[body].deformable)
                append(out[i], std::span(frame.deformed[body]));
            else
                append(out[i], std::span(&frame.poses[body], 1));
        }
    const auto in = passed(out, traffic);
    for (std::size_t i = 0; i < in.size(); ++i) {
        if (in[i].empty()) continue;
        MessageReader message(in[i]);
        for (const auto body : gotten_[i]) {
            if (scene_.bodies[body].deformable) {
                auto& vertices = frame.deformed[body];
                vertices.resize(scene_.meshes[scene_.bodies[body].mesh].vertices.size());
                message.read(std::span(vertices));
            } else {
                message.read(std::span(&frame.poses[body], 1));
            }
        }
    }
}

} // namespace tandem
