// SPDX-License-Identifier: MIT
#include "harness/verify/accuracy/truths.h"

#include "harness/verify/accuracy/answer_errors_json.h"
#include "harness/verify/reference.h"
#include "scenes/digest.h"
#include "base/error.h"
#include "base/memory.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

std::size_t pairs_in(const FrameTruth& truth) { return truth.touching.size() + truth.overlapping.size(); }

/// Throws early when the truth of all frames will not fit in memory, assuming that they are like the first,
/// with `pairs` pairs.
void check_capacity(std::size_t pairs, std::size_t frames) {
    const auto bytes = pairs * sizeof(Pair) * (frames - 1);
    const auto memory = free_memory();
    constexpr double gib = 1 << 30;
    if (bytes > memory)
        throw InputError(
            fmt::format("the exact truth of {} frames like the first takes {:.2f} GiB more, and {:.2f} GiB "
                        "are free; choose --truth none or fewer frames",
                        frames, static_cast<double>(bytes) / gib, static_cast<double>(memory) / gib));
}

/// Removes the distances of pairs that are apart: they answer that the pair does not meet.
void erase_apart(const FrameTruth& truth, std::vector<ContactPoint>& contacts) {
    std::erase_if(contacts, [&](const ContactPoint& contact) {
        return contact.depth > 0 && !std::ranges::binary_search(truth.touching, contact.pair)
               && !std::ranges::binary_search(truth.overlapping, contact.pair);
    });
}

} // namespace

Truths::Truths(const Scene& scene, const FrameRange& range, TruthAmount amount, std::size_t most_contacts,
               const std::filesystem::path& folder)
    : scene_(scene),
      range_(range),
      amount_(amount),
      most_contacts_(most_contacts),
      cache_(folder, fmt::format("truths of {} {:016x}", scene.key, scene.digest)) {}

/// Computed once and cached for all cells with the same positions.
const FrameTruth& Truths::truth_of(const FramePosition& position, const Report& report) {
    if (const auto found = truths_.find(position); found != truths_.end()) return found->second;
    const auto& [positions, index] = position;
    const auto frame = range_.frame(index, positions.origin);
    auto truth = frame_truth(scene_, *frame, positions, report, free_memory());
    if (index == 0) check_capacity(pairs_in(truth), range_.size());
    return truths_.emplace(position, std::move(truth)).first->second;
}

const MotionTruth& Truths::motion_truth_of(const FramePosition& position, const Report& report) {
    if (const auto found = motion_truths_.find(position); found != motion_truths_.end()) return found->second;
    const auto& [positions, index] = position;
    const auto state = range_.state(index, Motion::linear, positions.origin);
    auto truth = motion_truth(scene_, *state.frame, *state.next, positions, {report, free_memory()});
    return motion_truths_.emplace(position, std::move(truth)).first->second;
}

/// Pairs that the truth cannot decide are in no error.
PairErrors Truths::motion_errors(const FramePosition& position, const FrameAnswer& answer,
                                 std::vector<Pair> pairs, const Report& report) {
    const auto& motion = motion_truth_of(position, report);
    FrameTruth truth;
    truth.overlapping = pairs_walked(scene_, motion.colliding, answer.walked);
    truth.invalid = motion.invalid;
    std::erase_if(pairs,
                  [&](const Pair& pair) { return std::ranges::binary_search(motion.undecided, pair); });
    return pair_errors(truth, pairs);
}

const FrameTruth& Truths::walked_truth_of(const FramePosition& position, Walked walked,
                                          const Report& report) {
    const auto& whole = truth_of(position, report);
    if (walked == Walked::all) return whole;
    const std::pair key{position, walked};
    if (const auto found = part_truths_.find(key); found != part_truths_.end()) return found->second;
    auto part = whole;
    part.touching = pairs_walked(scene_, std::move(part.touching), walked);
    part.overlapping = pairs_walked(scene_, std::move(part.overlapping), walked);
    return part_truths_.emplace(key, std::move(part)).first->second;
}

RoundedFrame Truths::rounded_frame(const FramePosition& cell) const {
    const auto& [positions, index] = cell;
    return {scene_, range_.frame(index), range_.frame(index, positions.origin),
            range_.origin(positions.origin), positions};
}

/// The truth by the input is that by the cell's vertices where these are the input's.
Truths::FramePosition Truths::input_of(const FramePosition& cell) {
    auto found = rounds_.find(cell);
    if (found == rounds_.end()) found = rounds_.emplace(cell, rounds(rounded_frame(cell))).first;
    const auto& [positions, index] = cell;
    return found->second
               ? FramePosition{{positions.precision, Placement::exact, Origin::world, positions.self}, index}
               : cell;
}

/// The same for all answers to a frame: `missed` stays 0. `position`: of the pairs that `cell` must not miss.
const RoundingErrors& Truths::rounding_of(const FramePosition& cell, const FramePosition& position,
                                          Walked walked, const Report& report) {
    const std::tuple key{cell, position, walked};
    if (const auto found = roundings_.find(key); found != roundings_.end()) return found->second;
    const auto input_position = input_of(cell);
    const auto& own = walked_truth_of(position, walked, report);
    const auto& input = walked_truth_of(input_position, walked, report);
    if (cell.second == 0 && &input != &own) check_capacity(pairs_in(own) + pairs_in(input), range_.size());
    auto errors = rounding_errors(own, input);
    if (amount_ == TruthAmount::contacts)
        errors.depth_change =
            input_position == cell ? 0 : depth_change(rounded_frame(cell), own, input, most_contacts_);
    return roundings_.emplace(key, errors).first->second;
}

/// The answer's errors by the input.
RoundingErrors Truths::input_errors(const Geometry& geometry, const FramePosition& position,
                                    const FrameAnswer& answer, std::span<const Pair> pairs,
                                    const Report& report) {
    const FramePosition cell{{geometry.precision, Placement::rounded, geometry.origin, answer.self},
                             position.second};
    auto errors = rounding_of(cell, position, answer.walked, report);
    const auto found = pair_errors(walked_truth_of(input_of(cell), answer.walked, report), pairs);
    errors.missed = found.missed_touching + found.missed_overlapping;
    return errors;
}

const ContactTruths& Truths::contact_truths_of(const FramePosition& position, Walked walked,
                                               const FrameTruth& truth) {
    const std::pair key{position, walked};
    if (const auto found = contact_truths_.find(key); found != contact_truths_.end()) return found->second;
    const auto& [positions, index] = position;
    const auto frame = range_.frame(index, positions.origin);
    auto truths =
        contact_truths(scene_, *frame, positions, truth, most_contacts_, range_.origin(positions.origin));
    return contact_truths_.emplace(key, std::move(truths)).first->second;
}

const AnswerErrors& Truths::errors(const Geometry& geometry, std::size_t index, const FrameAnswer& answer,
                                   const Report& report) {
    const FramePosition position{{geometry.precision, geometry.placement, geometry.origin, answer.self},
                                 index};
    const std::tuple key{geometry.precision,
                         geometry.origin,
                         geometry.motion,
                         position,
                         answer.walked,
                         Numbers{answer.pairs.count, answer.pairs.a, answer.pairs.b, answer.contacts.count,
                                 answer.contacts.a, answer.contacts.b}};
    if (const auto found = errors_.find(key); found != errors_.end()) return found->second;
    const auto text = cache_key(geometry, position, answer);
    AnswerErrors cached;
    if (cache_.take(text, [&](const nlohmann::json& value) { value.get_to(cached); }))
        return errors_.emplace(key, std::move(cached)).first->second;
    const auto& errors = errors_.emplace(key, errors_of(geometry, position, answer, report)).first->second;
    cache_.keep(text, errors);
    return errors;
}

/// Identifies the frame by its content. The first frame of a range differs, because its errors include drift.
std::string Truths::cache_key(const Geometry& geometry, const FramePosition& position,
                              const FrameAnswer& answer) const {
    const auto& [positions, index] = position;
    const auto& p = answer.pairs;
    const auto& c = answer.contacts;
    return fmt::format(
        "frame {:016x}{}{}, precision {}, origin {}, positions {} {}{}, amount {} {}, walked {}, "
        "pairs {} {:x} {:x}, contacts {} {} {:x} {:x}",
        digest_of(*range_.frame(index)),
        geometry.motion == Motion::linear ? fmt::format(" to {:016x}", digest_of(*range_.frame(index + 1)))
                                          : "",
        index == 0 ? " first" : "", static_cast<int>(geometry.precision), static_cast<int>(geometry.origin),
        static_cast<int>(positions.precision), static_cast<int>(positions.placement),
        positions.self == SelfPairs::off ? "" : fmt::format(" self {}", static_cast<int>(positions.self)),
        static_cast<int>(amount_), most_contacts_, static_cast<int>(answer.walked), p.count, p.a, p.b,
        answer.makes_contacts, c.count, c.a, c.b);
}

const Drift& Truths::drift_of(const Geometry& geometry) {
    const std::pair key{geometry.precision, geometry.origin};
    if (const auto found = drifts_.find(key); found != drifts_.end()) return found->second;
    const auto first = range_.frame(0, geometry.origin);
    return drifts_.emplace(key, vertex_drift(scene_, *first, geometry.precision, geometry.origin))
        .first->second;
}

/// A download may throw; the caller then stores nothing, and the next cell tries again.
AnswerErrors Truths::errors_of(const Geometry& geometry, const FramePosition& position,
                               const FrameAnswer& answer, const Report& report) {
    AnswerErrors errors;
    const auto pairs = answer.download();
    errors.frames = 1;
    if (geometry.motion == Motion::linear) {
        errors.pairs = motion_errors(position, answer, pairs, report);
        errors.invalid_tetrahedra = motion_truth_of(position, report).invalid.size();
        if (!answer.makes_contacts) return errors;
    }
    const auto& truth = walked_truth_of(position, answer.walked, report);
    if (geometry.motion == Motion::none) {
        errors.pairs = pair_errors(truth, pairs);
        errors.rounding = input_errors(geometry, position, answer, pairs, report);
    }
    errors.decided = truth.decisions;
    errors.invalid_tetrahedra = truth.invalid.size();
    if (amount_ == TruthAmount::contacts && position.second == 0) errors.drift = drift_of(geometry);
    if (!answer.makes_contacts) return errors;
    if (answer.has_polygons && amount_ != TruthAmount::contacts) return errors;
    auto contacts = answer.download_contacts();
    const double unit = geometry.precision == Precision::fp64 ? 0x1p-53 : 0x1p-24;
    const auto& [positions, index] = position;
    const auto frame = range_.frame(index, positions.origin);
    if (answer.has_polygons) {
        errors.contacts = polygon_errors(scene_, *frame, positions, {truth, contacts}, unit, most_contacts_);
        errors.every_contact = errors.contacts->overlapping == truth.overlapping.size();
        return errors;
    }
    std::vector<ContactPoint> apart;
    if (answer.measures) {
        apart = contacts;
        erase_apart(truth, contacts);
    }
    errors.decisions = decision_matrix(truth, pairs, contacts);
    if (amount_ != TruthAmount::contacts) return errors;
    const auto& exact = contact_truths_of(position, answer.walked, truth);
    errors.every_contact = exact.every;
    errors.contacts = contact_errors(exact, contacts, unit, answer.measures);
    if (answer.measures)
        errors.contacts->distance_ulps =
            distance_errors(scene_, *frame, positions, apart, unit, most_contacts_);
    return errors;
}

} // namespace tandem
