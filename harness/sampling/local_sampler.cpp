// SPDX-License-Identifier: MIT
#include "harness/sampling/local_sampler.h"
#include "harness/plans/rank_team.h"

#include "algorithms/bounds/geometry.h"
#include "base/memory_reserve.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

/// Warming up ends after the longest time, or after the least time once several successive replays have not
/// been faster than the fastest one by more than the least gain. One replay alone is too noisy where a frame
/// lasts a tenth of a millisecond.
constexpr double least_gain = 0.02;
constexpr int replays_without_gain = 3;
constexpr std::int64_t least_warming_ns = 5'000'000;
constexpr std::int64_t longest_warming_ns = 250'000'000;

} // namespace

LocalSampler::LocalSampler(const Cell& cell, const Scene& scene, const FrameRange& range,
                           References& references, CellState state)
    : CellSampler(cell, std::move(state)),
      scene_(scene),
      range_(range),
      references_(references),
      name_(describe(cell)),
      out_(state_.measurement),
      conditions_(cell.devices) {}

void LocalSampler::begin_session() {
    replays_.reset(); // frees memory before the next session allocates
    MemoryReserve::refill();
    // Drops the facts of earlier cells' kernels, so that later ones belong to this cell.
    for (auto* device : cell_.devices) device->take_kernels();
    replays_.emplace(cell_, scene_, range_, stop_);
    state_.prepare_ns = replays_->prepare_ns();
    state_.replay_ns = -1;
}

/// Compares pair by pair where the answer has pairs. With output=count or digest it has only sums: a wrong
/// sum with the right count means at least one missing pair and one extra pair.
void LocalSampler::compare(std::size_t index, const FrameResult& result, const Digest& digest,
                           const Digest& contacts) {
    auto& agreement = out_.agreement;
    ++agreement.frames;
    const bool has_contacts = makes_contacts(out_.settings);
    const auto differs = [&] {
        const auto known = expected_digests(index);
        return digest != known.pairs || (has_contacts && contacts != known.contacts);
    };
    if (!decided(cell_.team, is_first(cell_.team) && differs())) return;
    const auto pairs = result.has_pairs() ? result.download() : std::vector<Pair>{};
    if (!is_first(cell_.team)) return;
    // An earlier process may have stored the expected digest: recompute before an answer counts as wrong.
    const auto& expected = references_.answer(geometry_, contact_settings_of(out_.settings), index);
    if (digest != expected.digest) {
        if (result.has_pairs()) {
            const auto found = difference(expected.pairs, pairs);
            agreement.missing += found.missing;
            agreement.extra += found.extra;
        } else {
            const auto more = expected.digest.count, found = result.count;
            agreement.missing += more > found ? more - found : (more == found ? 1 : 0);
            agreement.extra += found > more ? found - more : (more == found ? 1 : 0);
        }
    }
    if (has_contacts && contacts != expected.contact_digest) ++agreement.contact_frames_wrong;
}

ReferenceDigests LocalSampler::expected_digests(std::size_t index) {
    return references_.digests(geometry_, contact_settings_of(out_.settings), index);
}

void LocalSampler::add_dropped(std::size_t index) {
    if (!is_first(cell_.team) || !contact_settings_of(out_.settings).within_sphere_boxes) return;
    const auto expected = expected_digests(index);
    out_.dropped_body_pairs.push_back(expected.dropped_body_pairs);
    out_.dropped_candidate_pairs.push_back(expected.dropped_pairs);
}

/// Rules that need boundary faces of both tetrahedra take the depth along faces that need not be in contact.
/// The first frame with a contact beyond its body is enough, because contacts are many.
void LocalSampler::find_deep_contact(std::size_t index, const FrameResult& result, const Digest& digest) {
    if (!makes_contacts(out_.settings) || boundaries_needed(out_.settings[parameters::contact_rule]) != 2)
        return;
    if (!decided(cell_.team, !out_.deep_contact)) return;
    auto& searched = references_.searched(index, digest);
    if (decided(cell_.team, !searched)) {
        const auto contacts = result.download_contacts();
        if (!is_first(cell_.team)) return;
        searched = SearchedContacts{
            deepest_beyond_body(scene_, *range_.frame(index), range_.first() + index, contacts)};
    }
    if (is_first(cell_.team)) out_.deep_contact = searched->deepest;
}

/// Truths stores errors by digest, so that it downloads an answer only when no other cell had the same one.
/// Ranks download collectively, and therefore always.
void LocalSampler::add_errors(Truths& truths, std::size_t index, const FrameResult& result,
                              const Digest& digest, const Digest& contacts, const Report& report) {
    FrameAnswer answer;
    answer.pairs = digest;
    answer.contacts = contacts;
    const bool adds_up = out_.settings[parameters::output] == Output::wrenches;
    answer.makes_contacts = makes_contacts(out_.settings) && !adds_up;
    answer.has_polygons = has_polygons(out_.settings) && !adds_up;
    answer.measures = answer.makes_contacts && has_near_pairs(out_.settings[parameters::contact_rule]);
    answer.walked = walked_of(out_.settings);
    answer.self = out_.settings[parameters::self];
    std::vector<Pair> pairs;
    std::vector<ContactPoint> points;
    if (cell_.team != nullptr) {
        pairs = result.download();
        points = result.download_contacts();
        if (!cell_.team->is_first()) return;
    }
    answer.download = [&] { return cell_.team != nullptr ? pairs : result.download(); };
    answer.download_contacts = [&] { return cell_.team != nullptr ? points : result.download_contacts(); };
    if (!out_.errors) out_.errors.emplace();
    out_.errors->add(truths.errors(geometry_, index, answer, report));
}

/// The truth of pairs is of all pairs. That of motion has rounded positions.
bool LocalSampler::has_truth(const Truths& truths) const {
    if (geometry_.motion == Motion::linear && geometry_.placement == Placement::exact) return false;
    return truths.amount() == TruthAmount::contacts || !leaves_out_pairs(out_.settings[parameters::output]);
}

void LocalSampler::add_counts(const FrameResult& result) {
    out_.body_pairs.push_back(result.body_pairs);
    out_.candidate_pairs.push_back(result.count);
    out_.contacts.push_back(result.contacts);
    out_.counts += result;
}

/// Checks one answer of the checking replay.
void LocalSampler::check_answer(std::size_t index, const FrameResult& result, const CheckOptions& options) {
    const auto frame = fmt::format("frame {} of {}", index + 1, range_.size());
    const auto frames = static_cast<double>(range_.size()), done = static_cast<double>(index);
    options.progress(fmt::format("{}: checking {}", name_, frame), done / frames);
    // output=count has no digest: the count replaces it, and a correct count implies the expected digest.
    const bool counted = out_.settings[parameters::output] == Output::count;
    auto digest = counted ? Digest{result.count, 0, 0} : result.digest();
    const auto contacts = result.contact_digest();
    if (options.check) {
        if (counted && is_first(cell_.team))
            if (const auto expected = expected_digests(index).pairs; result.count == expected.count)
                digest = expected;
        compare(index, result, digest, contacts);
        add_dropped(index);
        find_deep_contact(index, result, contacts);
    }
    if (options.truths != nullptr && result.has_pairs() && has_truth(*options.truths))
        add_errors(*options.truths, index, result, digest, contacts,
                   [&](double fraction, std::uint64_t decided) {
                       // Only rank 0 computes the truth, and the other ranks wait for it.
                       if (cell_.team == nullptr && stop_()) throw Interrupted();
                       options.progress(fmt::format("{}: truth of {}: {:.0f} %, {} pairs decided", name_,
                                                    frame, fraction * 100, decided),
                                        (done + fraction) / frames);
                   });
    out_.agreement.digest += digest;
    out_.agreement.contact_digest += contacts;
    state_.digests.push_back(digest);
    add_counts(result);
}

/// Also compiles kernels, which some devices do at the first launch, and grows buffers. Later samples are
/// compared with the digests of this replay.
void LocalSampler::do_check(const CheckOptions& options) {
    options.progress(fmt::format("{}: preparing", name_), 0);
    begin_session();
    out_.prepare_ns = state_.prepare_ns;
    out_.settings = replays_->settings();
    out_.walked_tetrahedra = count_walked(scene_, walked_of(out_.settings));
    geometry_ = geometry_of(out_.settings);
    if (options.check && is_first(cell_.team))
        out_.flattened = count_flattened(scene_, *range_.frame(0, geometry_.origin), geometry_);
    const auto replay = replays_->timed(
        [&](std::size_t index, const FrameResult& result) { check_answer(index, result, options); });
    state_.replay_ns = replay.total_ns();
    is_compiled_ = true;
    for (const auto* device : cell_.devices) out_.device_bytes += device->bytes_allocated();
    take_kernels();
}

/// When another process has checked the cell, the first replay of this one compiles kernels, and warming up
/// must not count it.
void LocalSampler::compile() {
    if (is_compiled_) return;
    replays_->timed([](std::size_t, const FrameResult&) {});
    is_compiled_ = true;
}

/// Clocks rise, caches fill and buffers grow in the first replays of a session. Clocks can also have fallen
/// while the device was idle.
void LocalSampler::warm_up() {
    std::int64_t spent = 0;
    auto least = std::numeric_limits<std::int64_t>::max();
    int without_gain = 0;
    const auto continues = [&] {
        return (without_gain < replays_without_gain || spent < least_warming_ns)
               && spent < longest_warming_ns;
    };
    while (decided(cell_.team, continues())) {
        state_.replay_ns = replays_->timed([](std::size_t, const FrameResult&) {}).total_ns();
        spent += state_.replay_ns;
        const bool gained =
            static_cast<double>(state_.replay_ns) < static_cast<double>(least) * (1 - least_gain);
        without_gain = gained ? 0 : without_gain + 1;
        least = std::min(least, state_.replay_ns);
    }
}

/// Compares each answer with that of the checking replay, between frames and outside the timed span. A
/// different answer makes the cell wrong.
void LocalSampler::sample() {
    const auto before = replays_->submissions();
    std::uint64_t checking = 0;
    std::vector<std::vector<DeviceWork>> shared;
    auto replay = replays_->timed([&](std::size_t index, const FrameResult& result) {
        if (!result.shared.empty()) shared.push_back(result.shared);
        const auto begin = replays_->submissions();
        if (out_.settings[parameters::output] != Output::count && result.digest() != state_.digests[index])
            ++out_.agreement.extra;
        if (result.count != out_.candidate_pairs[index]) ++out_.agreement.extra;
        checking += replays_->submissions() - begin;
    });
    out_.submissions = replays_->submissions() - before - checking;
    out_.shared = std::move(shared);
    replay.round = state_.rounds;
    state_.replay_ns = replay.total_ns();
    out_.samples.push_back(std::move(replay));
}

void LocalSampler::do_round(std::size_t samples) {
    const auto begin = std::chrono::steady_clock::now();
    if (!replays_) begin_session();
    compile();
    if (samples > 0) {
        // Read conditions before warming up, because a reading lasts a third of a millisecond.
        RoundConditions conditions{state_.rounds, conditions_.read(), {}};
        warm_up();
        for (std::size_t i = 0; i < samples; ++i) sample();
        conditions.after = conditions_.read();
        out_.conditions.push_back(std::move(conditions));
    }
    auto breakdown = replays_->instrumented();
    breakdown.round = state_.rounds;
    out_.breakdowns.push_back(std::move(breakdown));
    ++state_.rounds;
    state_.spent_ns += since(begin);
}

void LocalSampler::do_count_work() {
    if (!replays_) begin_session();
    out_.work = replays_->counted();
    take_kernels();
    do_release();
}

/// Adds the facts of kernels that the devices have compiled since the last call; skips known kernels.
void LocalSampler::take_kernels() {
    for (auto* device : cell_.devices)
        for (auto& facts : device->take_kernels()) {
            const bool known = std::ranges::any_of(out_.kernels, [&](const KernelFacts& other) {
                return other.entry == facts.entry && other.defines == facts.defines;
            });
            if (!known) out_.kernels.push_back(std::move(facts));
        }
}

} // namespace tandem
