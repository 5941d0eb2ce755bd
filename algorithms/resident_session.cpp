// SPDX-License-Identifier: MIT
#include "algorithms/resident_session.h"

#include "algorithms/batches.h"
#include "algorithms/bodies/frame_on_device.h"

#include <fmt/format.h>
#include <utility>

namespace tandem {

void ResidentSession::take(const Subdomain& share) {
    stale_ = true; // bodies new to the share have no poses here
    steps_.bodies->take(share);
    steps_.steps.hierarchy->take(share, steps_.bodies->count());
    steps_.body_pairs->take(share);
}

void ResidentSession::receive(std::span<const std::uint32_t> bodies) {
    receives_ = !bodies.empty();
    is_placed_ = false;
    steps_.bodies->leave(bodies);
}

void ResidentSession::upload_vertices(const Frame& frame) {
    steps_.bodies->update_deformed(frame, true);
    is_placed_ = true;
}

void ResidentSession::do_reset() {
    steps_.body_pairs->reset();
    batches_ = 1;
}

FrameResult ResidentSession::do_run_device_input(const DeviceFrame& frame,
                                                 std::optional<std::span<const BodyPair>> body_pairs) {
    if (!pack_) pack_ = std::make_unique<PackStage>(*steps_.bodies, steps_.shape);
    return run_given({.there = &frame, .body_pairs = body_pairs});
}

/// Bodies and hierarchy as the frame has them; also those that do not move, unless a frame with them is known
/// to have run.
void ResidentSession::refresh(const Given& given) {
    const bool all = std::exchange(stale_, true);
    if (given.here != nullptr) {
        steps_.bodies->update_poses(*given.here, all);
        if (!std::exchange(is_placed_, false)) steps_.bodies->update_deformed(*given.here);
        steps_.steps.hierarchy->refit(*given.here, all);
        return;
    }
    pack_->launch(*given.there, origin(), steps_.status.buffer());
    steps_.steps.hierarchy->refit({.poses = {}, .deformed = {}, .skipped = given.there->skipped}, all);
}

void ResidentSession::find_body_pairs(const Given& given) {
    if (given.here != nullptr)
        steps_.body_pairs->begin(*given.here, given.body_pairs);
    else
        steps_.body_pairs->begin_on_device(given.body_pairs);
}

/// Whether the device would be idle while the host works or waits before the end of the frame's commands.
bool ResidentSession::waits_within_frame(const Given& given) const {
    const bool has_pairs = given.body_pairs.has_value();
    return given.here != nullptr ? steps_.body_pairs->works_on_host(has_pairs)
                                 : steps_.body_pairs->sorts_on_device(has_pairs);
}

/// Throws InputError when packing counted rows out of range, which stand in bounds as something else.
void ResidentSession::refuse_flaws(const Given& given) {
    if (given.there == nullptr) return;
    const auto flawed = steps_.status.counter(STATUS_FLAWED);
    if (flawed == 0) return;
    stale_ = true;
    refuse_flawed(steps_.device, scene_, *given.there, steps_.bodies->geometry().precision, flawed);
}

/// The frame's commands from body pairs to contacts.
void ResidentSession::launch(const AnswerBuffers& answer) {
    steps_.status.begin(steps_.body_pairs->on_host().size());
    walk(answer);
}

/// The same with counters that have begun.
void ResidentSession::walk(const AnswerBuffers& answer) {
    steps_.body_pairs->launch(steps_.status);
    const auto task = steps_.task(answer);
    if (task.most_pairs() == 0) return;
    steps_.steps.walker->launch(task);
    if (steps_.makes_contacts()) steps_.contacts->launch(answer, 0, answer.pairs.capacity(), steps_.status);
}

/// Makes room for what the status counts; true when the frame has to run again.
bool ResidentSession::grow(AnswerBuffers& answer) {
    const auto& status = steps_.status;
    bool again = steps_.steps.walker->grow(status);
    again |= steps_.body_pairs->grow(status);
    if (const auto found = status.counter(STATUS_PAIRS);
        steps_.output == Output::pairs && found > answer.pairs.capacity()) {
        answer.pairs.grow(found);
        again = true;
    }
    if (const auto contacts = status.counter(STATUS_CONTACTS);
        steps_.makes_contacts() && contacts > answer.contacts.capacity()) {
        answer.contacts.grow(contacts);
        again = true;
    }
    return again;
}

/// Everything of a frame up to its one wait, as one submission unless the device would be idle meanwhile.
/// Packing counts in the status, which therefore begins before it.
void ResidentSession::begin(const Given& given, const AnswerBuffers& answer) {
    const auto all = [&] {
        if (given.there != nullptr) steps_.status.begin(given.body_pairs ? given.body_pairs->size() : 0);
        refresh(given);
        find_body_pairs(given);
        if (given.there != nullptr)
            walk(answer);
        else
            launch(answer);
        steps_.status.read();
    };
    if (steps_.settings[parameters::submission] == Submission::one && !waits_within_frame(given))
        steps_.device.as_one(all);
    else
        all();
    stale_ = false;
    refuse_flaws(given);
}

FrameResult ResidentSession::run_whole(const Given& given) {
    auto answer = steps_.answers->take();
    begin(given, *answer);
    std::uint64_t retries = 0;
    for (;; ++retries) {
        if (steps_.contacts) steps_.contacts->expect(steps_.status.counter(STATUS_PAIRS));
        if (!grow(*answer)) break;
        launch(*answer);
        steps_.status.read();
    }
    auto result = steps_.counts();
    result.retries = retries;
    if (steps_.counting) steps_.steps.walker->report(steps_.status, result.work);
    steps_.add_part(result, std::move(answer));
    return result;
}

/// From the beginning: how far the frame came is not known.
FrameResult ResidentSession::run_parts(const Given& given) {
    if (receives_)
        throw OutOfMemory(fmt::format("{}: a frame in batches needs all vertices in the host's memory",
                                      steps_.device.info().id));
    if (given.there != nullptr) steps_.status.begin(0);
    refresh(given);
    if (given.there != nullptr) {
        steps_.status.read();
        refuse_flaws(given);
    }
    try {
        find_body_pairs(given);
    } catch (const OutOfMemory&) {} // its parts need less
    auto result = run_in_batches(steps_, given.here, given.body_pairs, batches_);
    stale_ = false;
    return result;
}

FrameResult ResidentSession::run_given(const Given& given) {
    try {
        if (batches_ == 1) return run_whole(given);
    } catch (const OutOfMemory&) {
        batches_ = 2;
    }
    return run_parts(given);
}

} // namespace tandem
