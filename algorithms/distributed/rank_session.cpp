// SPDX-License-Identifier: MIT
#include "algorithms/distributed/rank_session.h"

#include "algorithms/bodies/origin.h"
#include "algorithms/parameters/table.h"
#include "algorithms/distributed/agreement.h"
#include "algorithms/distributed/local_scene.h"
#include "base/error.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

namespace tandem {

namespace {

using Clock = std::chrono::steady_clock;

std::int64_t ns_since(Clock::time_point begin) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
}

/// Candidate pairs by body; empty when the device fails. The remaining ranks wait for this rank's message, a
/// partition works without counts, and the next frame reports the failure.
std::vector<std::uint64_t> counts_of(const FrameResult& result) {
    std::vector<std::uint64_t> counts;
    try {
        for (const auto& part : result.parts) part->count_by_body(counts);
    } catch (const DeviceError&) {
        counts.clear();
    }
    return counts;
}

/// Frame 0, relative to the origin of the settings.
Frame start_of(const Scene& scene, const Settings& settings) {
    return counted_from(origin_of(scene, geometry_of(settings).origin), scene.frame(0));
}

/// The balls of all bodies.
std::vector<Ball> balls_of(const Scene& scene, const Frame& frame) {
    DisplacementTracker tracker(scene);
    std::vector<std::uint32_t> all(scene.bodies.size());
    std::iota(all.begin(), all.end(), 0u);
    tracker.set_reference(frame, all);
    std::vector<Ball> balls;
    balls.reserve(all.size());
    for (const auto body : all) balls.push_back(tracker.ball(body));
    return balls;
}

} // namespace

RankSession::RankSession(const Traversal& traversal, Device& device, const Scene& scene, Settings fitted,
                         Ranks& ranks)
    : traversal_(traversal),
      devices_{&device},
      scene_(scene),
      settings_(std::move(fitted)),
      ranks_(ranks),
      partition_(scene, settings_, static_cast<std::size_t>(ranks.size())),
      ghosts_(scene, geometry_of(settings_), ranks),
      device_exchange_(ranks, device.info(), scene, settings_),
      tracker_(scene),
      has_successors_(settings_[parameters::motion] == Motion::linear) {
    const auto start = start_of(scene, settings_);
    balls_ = balls_of(scene, start);
    partition_.repartition(balls_);
    // Compilation and allocation take place before the first frame, which is measured.
    Report own;
    exchange(start, own);
    throw_failure(gather_reports(own));
}

void RankSession::do_reset() {
    if (session_) session_->reset();
}

void RankSession::do_count_work(bool on) {
    counts_work_ = on;
    if (session_) session_->count_work(on);
}

FrameResult RankSession::do_run_device_input(const DeviceFrameInput&,
                                             std::optional<std::span<const BodyPair>>) {
    throw InputError(
        fmt::format("{}: ranks of a job exchange bodies through the host's memory; give the frame in the "
                    "host's memory",
                    devices_.front()->info().id));
}

void RankSession::discard_session() {
    session_.reset(); // first, because it refers to the scene
    local_scene_.reset();
}

/// Makes a session of these bodies only. It continues with the answer buffers of the last session.
void RankSession::build_session(const std::vector<std::uint32_t>& bodies) {
    const auto answers = session_ ? session_->answers() : nullptr;
    discard_session(); // frees its memory for the next session
    local_scene_ = local_subscene(scene_, bodies);
    local_frame_ = {std::vector<Pose>(bodies.size()),
                    std::vector<std::vector<Eigen::Vector3d>>(bodies.size())};
    local_next_ = local_frame_;
    auto& device = *devices_.front();
    device.compile_together([&] {
        session_ = std::make_unique<ResidentSession>(traversal_, device, *local_scene_, settings_, answers);
    });
    if (counts_work_) session_->count_work(true);
}

/// A new session takes as long as several frames. Therefore it keeps the bodies of the last session and adds
/// the next ghosts, as far as memory allows: bodies at the border come and go.
void RankSession::build_session_for(const std::vector<std::uint32_t>& needed) {
    auto next = ghosts_.next_ghosts();
    std::ranges::sort(next);
    std::vector<std::uint32_t> with_next, all;
    std::ranges::set_union(needed, next, std::back_inserter(with_next));
    std::ranges::set_union(with_next, session_ ? local_scene_->numbers : next, std::back_inserter(all));
    const bool keeps_answers = session_ != nullptr;
    try {
        build_session(all);
    } catch (const OutOfMemory&) {
        if (all == needed && !keeps_answers) throw;
        build_session(needed); // without the last session's answer buffers, which are freed at this point
    }
}

void RankSession::update_device() {
    const auto& subdomain = ghosts_.subdomain();
    if (subdomain.own.empty()) return discard_session();
    auto needed = subdomain.own;
    needed.insert(needed.end(), subdomain.ghosts.begin(), subdomain.ghosts.end());
    std::ranges::sort(needed);
    if (!session_ || !std::ranges::includes(local_scene_->numbers, needed)) build_session_for(needed);
    local_subdomain_ = to_local(*local_scene_, subdomain);
    session_->set_subdomain(local_subdomain_);
    session_->expect(std::exchange(expected_pairs_, 0), partition_.contacts_a_pair());
    std::vector<std::uint32_t> received;
    if (device_exchange_.is_enabled())
        for (const auto& bodies : ghosts_.deformed_received())
            for (const auto body : bodies)
                received.push_back(static_cast<std::uint32_t>(local_index(*local_scene_, body)));
    session_->set_received(received);
}

/// Copies the states of the subdomain's bodies to a local frame.
void RankSession::copy_local_frame(const Frame& frame, const Frame& ghost_frame, Frame& local_frame) const {
    const auto copy = [&](const std::vector<std::uint32_t>& bodies, const std::vector<std::uint32_t>& local,
                          bool are_own) {
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const auto number = bodies[i], body = local[i];
            const bool is_local = are_own || scene_.bodies[number].fixed;
            const auto& from = is_local ? frame : ghost_frame;
            local_frame.poses[body] = from.poses[number];
            if (scene_.bodies[number].deformable && (is_local || !device_exchange_.is_enabled()))
                local_frame.deformed[body] = from.deformed[number];
            const bool skips = !from.skipped.empty() && !from.skipped[number].empty();
            if (skips) local_frame.skipped.resize(local_scene_->bodies.size());
            if (!local_frame.skipped.empty())
                local_frame.skipped[body] = skips ? from.skipped[number] : std::vector<std::uint32_t>{};
        }
    };
    copy(ghosts_.subdomain().own, local_subdomain_.own, true);
    copy(ghosts_.subdomain().ghosts, local_subdomain_.ghosts, false);
}

/// The same for the frame and its successor.
void RankSession::copy_local_input(const FrameInput& input) {
    copy_local_frame(input.frame, ghosts_.ghost_frame(), local_frame_);
    if (input.next == nullptr) return;
    copy_local_frame(*input.next, ghosts_.next_ghost_frame(), local_next_);
}

void RankSession::record_failure(const std::exception& error, Report& own) {
    own.failure = error.what();
    own.is_out_of_memory = dynamic_cast<const OutOfMemory*>(&error) != nullptr;
}

/// Collective: uploads own vertices, then exchanges vertices between devices.
void RankSession::exchange_vertices(const FrameInput& input, GhostExchange::Traffic& traffic, Report& own) {
    if (session_ && own.failure.empty()) {
        try {
            copy_local_input(input);
            session_->upload_vertices(local_frame_);
        } catch (const std::exception& error) {
            record_failure(error, own);
        }
    }
    const bool is_usable = session_ && own.failure.empty();
    device_exchange_.exchange(ghosts_, is_usable ? session_->bodies() : nullptr, local_scene_.get(), traffic);
}

/// Collective: exchanges ghosts. A rank takes part in all exchanges also after an error, which would block
/// the other ranks otherwise.
void RankSession::exchange(const FrameInput& input, Report& own) {
    const HostWork work(*devices_.front(), Stage::exchange, "bodies of other ranks");
    const auto begin = Clock::now();
    GhostExchange::Traffic traffic;
    if (ghosts_.is_expired(input, traffic)) {
        ghosts_.rebuild(own_bodies(), input, traffic);
        try {
            update_device();
        } catch (const std::exception& error) {
            record_failure(error, own);
            discard_session();
            ghosts_.invalidate();
        }
    }
    ghosts_.exchange_states(input, traffic, !device_exchange_.is_enabled());
    if (device_exchange_.is_enabled()) exchange_vertices(input, traffic, own);
    own.work.exchange_ns = ns_since(begin);
    own.work.exchange_bytes = traffic.bytes;
    own.work.messages = traffic.messages;
}

/// A frame that needs batches needs all vertices in the host's memory. The device exchange is disabled on all
/// ranks after such a frame.
FrameResult RankSession::run_local(Report& own) {
    if (!device_exchange_.is_enabled()) return session_->run(FrameView(local_input()).checked());
    try {
        return session_->run(FrameView(local_input()).checked());
    } catch (const OutOfMemory&) {
        own.needs_batches = true;
    }
    device_exchange_.download_received(ghosts_, *session_->bodies(), *local_scene_, local_frame_);
    session_->set_received({});
    return session_->run(FrameView(local_input()).checked());
}

void RankSession::run_subdomain(const FrameInput& input, FrameResult& result, Report& own) {
    if (!own.failure.empty() || !session_) return;
    const auto begin = Clock::now();
    try {
        if (!device_exchange_.is_enabled()) copy_local_input(input); // includes the received states
        result = run_local(own);
    } catch (const std::exception& error) {
        record_failure(error, own);
        return;
    }
    for (auto& part : result.parts) part = owning_part(std::move(part), local_scene_);
    own.work.bodies = ghosts_.subdomain().own.size() + ghosts_.subdomain().ghosts.size();
    own.work.body_pairs = result.body_pairs;
    own.work.pairs = result.count;
    own.work.ns = ns_since(begin);
    own.is_representative = result.retries == 0 && result.batches <= 1;
}

/// Throws the error of the lowest rank that has one, on all ranks.
void RankSession::throw_failure(const std::vector<Report>& all) const {
    const auto failed =
        std::ranges::find_if(all, [](const Report& report) { return !report.failure.empty(); });
    if (failed == all.end()) return;
    if (failed->is_out_of_memory) throw SharedError<OutOfMemory>(failed->failure);
    throw SharedError<DeviceError>(failed->failure);
}

/// Collective: the reports of all ranks.
std::vector<RankSession::Report> RankSession::gather_reports(const Report& own) {
    Ranks::Bytes message;
    append(message, std::span(&own.work, 1));
    append(message, std::span(&own.is_out_of_memory, 1));
    append(message, std::span(&own.is_representative, 1));
    append(message, std::span(&own.needs_batches, 1));
    append_text(message,
                own.failure.empty() ? own.failure : fmt::format("rank {}: {}", ranks_.rank(), own.failure));
    std::vector<Report> all;
    for (const auto& bytes : ranks_.gather_to_all(message)) {
        MessageReader reader(bytes);
        auto& report = all.emplace_back();
        report.work = reader.read<DeviceWork>();
        report.is_out_of_memory = reader.read<bool>();
        report.is_representative = reader.read<bool>();
        report.needs_batches = reader.read<bool>();
        report.failure = reader.read_text();
    }
    return all;
}

/// The balls of this rank's own bodies, then its nonzero candidate pairs by body.
Ranks::Bytes RankSession::calibration_message(const Frame& frame, const FrameResult& result) {
    tracker_.set_reference(frame, own_bodies());
    Ranks::Bytes message;
    for (const auto body : own_bodies()) append(message, std::span(&tracker_.ball(body), 1));
    const auto counts = counts_of(result);
    for (std::uint32_t body = 0; body < counts.size(); ++body) {
        const std::array<std::uint64_t, 2> row{body, counts[body]};
        if (counts[body] > 0) append(message, std::span<const std::uint64_t>(row));
    }
    return message;
}

/// Collective: takes the balls of all ranks. Returns the candidate pairs of all ranks by body.
std::vector<std::uint64_t> RankSession::exchange_calibration(const Frame& frame, const FrameResult& result) {
    std::vector<std::uint64_t> counts(scene_.bodies.size());
    const auto all = ranks_.gather_to_all(calibration_message(frame, result));
    for (std::size_t rank = 0; rank < all.size(); ++rank) {
        MessageReader message(all[rank]);
        for (const auto body : partition_.subdomains()[rank].own) message.read(std::span(&balls_[body], 1));
        while (!message.is_at_end()) {
            const auto [body, count] = message.read<std::array<std::uint64_t, 2>>();
            counts[body] += count;
        }
    }
    return counts;
}

/// Collective: all ranks compute the same partition from the same values.
void RankSession::repartition_if_needed(const Frame& frame, FrameResult& result) {
    std::optional<HostWork> timed;
    const bool is_unbalanced = partition_.add_sample(result, [&] {
        timed.emplace(*devices_.front(), Stage::exchange, "partition bodies");
        return exchange_calibration(frame, result);
    });
    if (!is_unbalanced) return;
    partition_.repartition(balls_);
    expected_pairs_ = partition_.partitioner().expected_pairs(static_cast<std::size_t>(ranks_.rank()));
    ghosts_.invalidate();
    result.repartitions = 1;
}

FrameResult RankSession::do_run(const FrameInput& input,
                                std::optional<std::span<const BodyPair>> body_pairs) {
    if (body_pairs) throw InputError("run() was given body pairs, which ranks of a job find themselves");
    Report own;
    FrameResult result;
    exchange(input, own);
    run_subdomain(input, result, own);
    const auto all = gather_reports(own);
    if (std::ranges::any_of(all, &Report::needs_batches)) {
        device_exchange_.disable();
        ghosts_.invalidate(); // the next rebuild updates the sessions
    }
    throw_failure(all);
    result.shared.clear();
    bool is_representative = true;
    for (const auto& report : all) {
        result.shared.push_back(report.work);
        is_representative = is_representative && report.is_representative;
    }
    if (is_representative) repartition_if_needed(input.frame, result);
    return result;
}

} // namespace tandem
