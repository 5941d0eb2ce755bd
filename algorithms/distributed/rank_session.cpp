// SPDX-License-Identifier: MIT
#include "algorithms/distributed/rank_session.h"

#include "algorithms/parameters/table.h"
#include "algorithms/distributed/agreement.h"
#include "algorithms/distributed/local_scene.h"
#include "base/error.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <iterator>
#include <numeric>
#include <utility>

namespace tandem {

namespace {

using Clock = std::chrono::steady_clock;

std::int64_t ns_since(Clock::time_point begin) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
}

/// Candidate pairs by body. None where the device fails: the others wait for this rank's message, a deal
/// needs no counts, and the next frame will fail as well.
std::vector<std::uint64_t> counts_of(const FrameResult& result) {
    std::vector<std::uint64_t> counts;
    try {
        for (const auto& part : result.parts) part->count_by_body(counts);
    } catch (const DeviceError&) {
        counts.clear();
    }
    return counts;
}

/// Where frame 0 has them all.
std::vector<Ball> balls_at_the_start(const Scene& scene) {
    DisplacementTracker places(scene);
    std::vector<std::uint32_t> all(scene.bodies.size());
    std::iota(all.begin(), all.end(), 0u);
    places.set_reference(scene.frame(0), all);
    std::vector<Ball> balls;
    balls.reserve(all.size());
    for (const auto body : all) balls.push_back(places.ball(body));
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
      partitioner_(scene, geometry_of(settings_), static_cast<std::size_t>(ranks.size())),
      balancer_(static_cast<std::size_t>(ranks.size())),
      ghosts_(scene, geometry_of(settings_), ranks),
      device_exchange_(ranks, device.info(), scene, settings_),
      places_(scene),
      balls_(balls_at_the_start(scene)) {
    partitioner_.partition(balls_, balancer_.speeds());
    // What compiles and allocates does so now, and not in the first frame.
    Report own;
    exchange(scene.frame(0), own);
    fail(reports(own));
}

void RankSession::do_reset() {
    if (session_) session_->reset();
}

void RankSession::do_count_work(bool on) {
    counts_work_ = on;
    if (session_) session_->count_work(on);
}

FrameResult RankSession::do_run_device_input(const DeviceFrame&, std::optional<std::span<const BodyPair>>) {
    throw InputError(
        fmt::format("{}: ranks of a job tell each other where bodies are, from the host's memory; "
                    "give the frame there",
                    devices_.front()->info().id));
}

void RankSession::drop() {
    session_.reset(); // which refers to the scene
    local_scene_.reset();
}

/// A session of those bodies alone, with as much room for answers as the last had.
void RankSession::build(const std::vector<std::uint32_t>& bodies) {
    const auto answers = session_ ? session_->answers() : nullptr;
    drop(); // before the next takes memory
    local_scene_ = local_subscene(scene_, bodies);
    local_frame_ = {std::vector<Pose>(bodies.size()),
                    std::vector<std::vector<Eigen::Vector3d>>(bodies.size())};
    session_ =
        std::make_unique<ResidentSession>(traversal_, *devices_.front(), *local_scene_, settings_, answers);
    if (counts_work_) session_->count_work(true);
}

/// Making a session anew takes as long as several frames: as long as there is room, bodies that were there
/// stay, since those at the border come and go, and those come along that will be next.
void RankSession::build_for(const std::vector<std::uint32_t>& needed) {
    auto next = ghosts_.next_ghosts();
    std::ranges::sort(next);
    std::vector<std::uint32_t> some, all;
    std::ranges::set_union(needed, next, std::back_inserter(some));
    std::ranges::set_union(some, session_ ? local_scene_->numbers : next, std::back_inserter(all));
    const bool keeps_answers = session_ != nullptr;
    try {
        build(all);
    } catch (const OutOfMemory&) {
        if (all == needed && !keeps_answers) throw;
        build(needed); // without the answer buffers of the session before, which are gone by now
    }
}

void RankSession::apply_subdomain() {
    const auto& subdomain = ghosts_.subdomain();
    if (subdomain.own.empty()) return drop();
    auto needed = subdomain.own;
    needed.insert(needed.end(), subdomain.ghosts.begin(), subdomain.ghosts.end());
    std::ranges::sort(needed);
    if (!session_ || !std::ranges::includes(local_scene_->numbers, needed)) build_for(needed);
    local_subdomain_ = to_local(*local_scene_, subdomain);
    session_->take(local_subdomain_);
    session_->expect(std::exchange(expected_pairs_, 0), contacts_a_pair_);
    std::vector<std::uint32_t> received;
    if (device_exchange_.is_enabled())
        for (const auto& bodies : ghosts_.deformed_received())
            for (const auto body : bodies)
                received.push_back(static_cast<std::uint32_t>(local_index(*local_scene_, body)));
    session_->receive(received);
}

/// Of bodies that have a part in this rank's share.
void RankSession::take_frame(const Frame& frame) {
    const auto take = [&](const std::vector<std::uint32_t>& bodies, const std::vector<std::uint32_t>& local,
                          bool are_own) {
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const auto number = bodies[i], body = local[i];
            const bool is_here = are_own || scene_.bodies[number].fixed;
            const auto& from = is_here ? frame : ghosts_.ghost_frame();
            local_frame_.poses[body] = from.poses[number];
            if (scene_.bodies[number].deformable && (is_here || !device_exchange_.is_enabled()))
                local_frame_.deformed[body] = from.deformed[number];
            const bool skips = !from.skipped.empty() && !from.skipped[number].empty();
            if (skips) local_frame_.skipped.resize(local_scene_->bodies.size());
            if (!local_frame_.skipped.empty())
                local_frame_.skipped[body] = skips ? from.skipped[number] : std::vector<std::uint32_t>{};
        }
    };
    take(ghosts_.subdomain().own, local_subdomain_.own, true);
    take(ghosts_.subdomain().ghosts, local_subdomain_.ghosts, false);
}

void RankSession::note(const std::exception& error, Report& own) {
    own.failure = error.what();
    own.is_memory = dynamic_cast<const OutOfMemory*>(&error) != nullptr;
}

/// From device to device, once this one has its own.
void RankSession::pass_vertices(const Frame& frame, GhostExchange::Traffic& traffic, Report& own) {
    if (session_ && own.failure.empty()) {
        try {
            take_frame(frame);
            session_->upload_vertices(local_frame_);
        } catch (const std::exception& error) {
            note(error, own);
        }
    }
    const bool is_there = session_ && own.failure.empty();
    device_exchange_.exchange(ghosts_, is_there ? &session_->bodies() : nullptr, local_scene_.get(), traffic);
}

/// What others have to say of a frame. Every rank passes the same messages, whatever becomes of it.
void RankSession::exchange(const Frame& frame, Report& own) {
    const HostWork work(*devices_.front(), Stage::exchange, "bodies of other ranks");
    const auto begin = Clock::now();
    GhostExchange::Traffic traffic;
    if (ghosts_.is_expired(frame, traffic)) {
        ghosts_.rebuild(own_bodies(), frame, traffic);
        try {
            apply_subdomain();
        } catch (const std::exception& error) {
            note(error, own);
            drop();
            ghosts_.forget();
        }
    }
    ghosts_.exchange_states(frame, traffic, !device_exchange_.is_enabled());
    if (device_exchange_.is_enabled()) pass_vertices(frame, traffic, own);
    own.work.exchange_ns = ns_since(begin);
    own.work.exchange_bytes = traffic.bytes;
    own.work.messages = traffic.messages;
}

/// A frame that needs batches needs all vertices here, this time and from now on.
FrameResult RankSession::run_local(Report& own) {
    if (!device_exchange_.is_enabled()) return session_->run(local_frame_);
    try {
        return session_->run(local_frame_);
    } catch (const OutOfMemory&) {
        own.is_in_batches = true;
    }
    device_exchange_.download_received(ghosts_, session_->bodies(), *local_scene_, local_frame_);
    session_->receive({});
    return session_->run(local_frame_);
}

void RankSession::walk(const Frame& frame, FrameResult& result, Report& own) {
    if (!own.failure.empty() || !session_) return;
    const auto begin = Clock::now();
    try {
        if (!device_exchange_.is_enabled()) take_frame(frame); // with what came
        result = run_local(own);
    } catch (const std::exception& error) {
        note(error, own);
        return;
    }
    for (auto& part : result.parts) part = owning_part(std::move(part), local_scene_);
    own.work.bodies = ghosts_.subdomain().own.size() + ghosts_.subdomain().ghosts.size();
    own.work.body_pairs = result.body_pairs;
    own.work.pairs = result.count;
    own.work.ns = ns_since(begin);
    own.is_usual = result.retries == 0 && result.batches <= 1;
}

/// Throws the error of the first rank that had one, on all of them.
void RankSession::fail(const std::vector<Report>& all) const {
    const auto failed =
        std::ranges::find_if(all, [](const Report& report) { return !report.failure.empty(); });
    if (failed == all.end()) return;
    if (failed->is_memory) throw SharedError<OutOfMemory>(failed->failure);
    throw SharedError<DeviceError>(failed->failure);
}

/// Of all ranks.
std::vector<RankSession::Report> RankSession::reports(const Report& own) {
    Ranks::Bytes message;
    append(message, std::span(&own.work, 1));
    append(message, std::span(&own.is_memory, 1));
    append(message, std::span(&own.is_usual, 1));
    append(message, std::span(&own.is_in_batches, 1));
    append_text(message,
                own.failure.empty() ? own.failure : fmt::format("rank {}: {}", ranks_.rank(), own.failure));
    std::vector<Report> all;
    for (const auto& bytes : ranks_.gather_to_all(message)) {
        MessageReader reader(bytes);
        auto& report = all.emplace_back();
        report.work = reader.read<DeviceWork>();
        report.is_memory = reader.read<bool>();
        report.is_usual = reader.read<bool>();
        report.is_in_batches = reader.read<bool>();
        report.failure = reader.read_text();
    }
    return all;
}

/// Where this rank's bodies are, and the candidate pairs of those that it has some of.
Ranks::Bytes RankSession::calibration_message(const Frame& frame, const FrameResult& result) {
    places_.set_reference(frame, own_bodies());
    Ranks::Bytes message;
    for (const auto body : own_bodies()) append(message, std::span(&places_.ball(body), 1));
    const auto counts = counts_of(result);
    for (std::uint32_t body = 0; body < counts.size(); ++body) {
        const std::array<std::uint64_t, 2> row{body, counts[body]};
        if (counts[body] > 0) append(message, std::span<const std::uint64_t>(row));
    }
    return message;
}

/// All ranks see the same numbers and come to the same end.
void RankSession::repartition(const Frame& frame, FrameResult& result) {
    std::vector<double> work;
    for (std::size_t i = 0; i < result.shared.size(); ++i)
        work.push_back(partitioner_.work_of(i, result.shared[i].pairs));
    balancer_.add_sample(result.shared, work);
    if (!balancer_.should_repartition()) return;
    const HostWork timed(*devices_.front(), Stage::exchange, "deal bodies");
    std::vector<std::uint64_t> counts(scene_.bodies.size());
    const auto all = ranks_.gather_to_all(calibration_message(frame, result));
    for (std::size_t rank = 0; rank < all.size(); ++rank) {
        MessageReader message(all[rank]);
        for (const auto body : partitioner_.subdomains()[rank].own) message.read(std::span(&balls_[body], 1));
        while (!message.is_at_end()) {
            const auto [body, count] = message.read<std::array<std::uint64_t, 2>>();
            counts[body] += count;
        }
    }
    if (settings_[parameters::output] == Output::pairs) partitioner_.calibrate(counts);
    partitioner_.partition(balls_, balancer_.speeds());
    balancer_.repartitioned();
    expected_pairs_ = partitioner_.expected_pairs(static_cast<std::size_t>(ranks_.rank()));
    contacts_a_pair_ = result.contacts_a_pair();
    ghosts_.forget();
    result.repartitions = 1;
}

FrameResult RankSession::do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) {
    if (body_pairs) throw InputError("run() was given body pairs, which ranks of a job find themselves");
    Report own;
    FrameResult result;
    exchange(frame, own);
    walk(frame, result, own);
    const auto all = reports(own);
    if (std::ranges::any_of(all, &Report::is_in_batches)) {
        device_exchange_.disable();
        ghosts_.forget(); // sessions are told at the next meeting
    }
    fail(all);
    result.shared.clear();
    bool is_usual = true;
    for (const auto& report : all) {
        result.shared.push_back(report.work);
        is_usual = is_usual && report.is_usual;
    }
    if (is_usual) repartition(frame, result);
    return result;
}

} // namespace tandem
