// SPDX-License-Identifier: MIT
#include "algorithms/resident_session.h"

#include "algorithms/batches.h"
#include "algorithms/bodies/frame_on_device.h"

#include <fmt/format.h>
#include <utility>

namespace tandem {

void ResidentSession::take(const Subdomain& share) {
    stale_ = true; // bodies new to the share have no poses here
    pipeline_.bodies->set_subdomain(share);
    pipeline_.stages.hierarchy->take(share, pipeline_.bodies->count());
    pipeline_.body_pairs->take(share);
}

void ResidentSession::receive(std::span<const std::uint32_t> bodies) {
    receives_ = !bodies.empty();
    is_placed_ = false;
    pipeline_.bodies->exclude_from_upload(bodies);
}

void ResidentSession::upload_vertices(const Frame& frame) {
    pipeline_.bodies->update_deformed(frame, true);
    is_placed_ = true;
}

void ResidentSession::do_reset() {
    pipeline_.body_pairs->reset();
    batches_ = 1;
}

FrameResult ResidentSession::do_run_device_input(const DeviceFrame& frame,
                                                 std::optional<std::span<const BodyPair>> body_pairs) {
    if (!pack_) pack_ = std::make_unique<PackStage>(*pipeline_.bodies, pipeline_.shape);
    return run_given({.there = &frame, .body_pairs = body_pairs});
}

/// Bodies and hierarchy as the frame has them; also those that do not move, unless a frame with them is known
/// to have run.
void ResidentSession::refresh(const Given& given) {
    const bool all = std::exchange(stale_, true);
    if (given.here != nullptr) {
        pipeline_.bodies->update_poses(*given.here, all);
        if (!std::exchange(is_placed_, false)) pipeline_.bodies->update_deformed(*given.here);
        pipeline_.stages.hierarchy->refit(*given.here, all);
        return;
    }
    pack_->launch(*given.there, origin(), pipeline_.status.buffer());
    pipeline_.stages.hierarchy->refit({.poses = {}, .deformed = {}, .skipped = given.there->skipped}, all);
}

void ResidentSession::find_body_pairs(const Given& given) {
    if (given.here != nullptr)
        pipeline_.body_pairs->begin(*given.here, given.body_pairs);
    else
        pipeline_.body_pairs->begin_on_device(given.body_pairs);
}

/// Whether the device would be idle while the host works or waits before the end of the frame's commands.
bool ResidentSession::waits_within_frame(const Given& given) const {
    const bool has_pairs = given.body_pairs.has_value();
    return given.here != nullptr ? pipeline_.body_pairs->works_on_host(has_pairs)
                                 : pipeline_.body_pairs->sorts_on_device(has_pairs);
}

/// Throws InputError when packing counted rows out of range, which stand in bounds as something else.
void ResidentSession::refuse_flaws(const Given& given) {
    if (given.there == nullptr) return;
    const auto flawed = pipeline_.status.counter(STATUS_FLAWED);
    if (flawed == 0) return;
    stale_ = true;
    refuse_flawed(pipeline_.device, scene_, *given.there, pipeline_.bodies->geometry().precision, flawed);
}

/// The frame's commands from body pairs to contacts.
void ResidentSession::launch(const AnswerBuffers& answer) {
    pipeline_.status.begin(pipeline_.body_pairs->on_host().size());
    walk(answer);
}

/// The same with counters that have begun.
void ResidentSession::walk(const AnswerBuffers& answer) {
    pipeline_.body_pairs->launch(pipeline_.status);
    const auto task = pipeline_.task(answer);
    if (task.most_pairs() == 0) return;
    pipeline_.stages.walker->launch(task);
    if (pipeline_.makes_contacts())
        pipeline_.contacts->launch(answer, 0, answer.pairs.capacity(), pipeline_.status);
}

/// Makes room for what the status counts; true when the frame has to run again.
bool ResidentSession::grow(AnswerBuffers& answer) {
    const auto& status = pipeline_.status;
    bool again = pipeline_.stages.walker->grow(status);
    again |= pipeline_.body_pairs->grow(status);
    if (const auto found = status.counter(STATUS_PAIRS);
        pipeline_.output == Output::pairs && found > answer.pairs.capacity()) {
        answer.pairs.grow(found);
        again = true;
    }
    if (const auto contacts = status.counter(STATUS_CONTACTS);
        pipeline_.makes_contacts() && contacts > answer.contacts.capacity()) {
        answer.contacts.grow(contacts);
        again = true;
    }
    return again;
}

/// Everything of a frame up to its one wait, as one submission unless the device would be idle meanwhile.
/// Packing counts in the status, which therefore begins before it.
void ResidentSession::begin(const Given& given, const AnswerBuffers& answer) {
    const auto all = [&] {
        if (given.there != nullptr) pipeline_.status.begin(given.body_pairs ? given.body_pairs->size() : 0);
        refresh(given);
        find_body_pairs(given);
        if (given.there != nullptr)
            walk(answer);
        else
            launch(answer);
        pipeline_.status.read();
    };
    if (pipeline_.settings[parameters::submission] == Submission::one && !waits_within_frame(given))
        pipeline_.device.as_one(all);
    else
        all();
    stale_ = false;
    refuse_flaws(given);
}

FrameResult ResidentSession::run_whole(const Given& given) {
    auto answer = pipeline_.answers->take();
    begin(given, *answer);
    std::uint64_t retries = 0;
    for (;; ++retries) {
        if (pipeline_.contacts) pipeline_.contacts->expect(pipeline_.status.counter(STATUS_PAIRS));
        if (!grow(*answer)) break;
        launch(*answer);
        pipeline_.status.read();
    }
    auto result = pipeline_.counts();
    result.retries = retries;
    if (pipeline_.counting) pipeline_.stages.walker->report(pipeline_.status, result.work);
    pipeline_.add_part(result, std::move(answer));
    return result;
}

/// From the beginning: how far the frame came is not known.
FrameResult ResidentSession::run_parts(const Given& given) {
    if (receives_)
        throw OutOfMemory(fmt::format("{}: a frame in batches needs all vertices in the host's memory",
                                      pipeline_.device.info().id));
    if (given.there != nullptr) pipeline_.status.begin(0);
    refresh(given);
    if (given.there != nullptr) {
        pipeline_.status.read();
        refuse_flaws(given);
    }
    try {
        find_body_pairs(given);
    } catch (const OutOfMemory&) {} // its parts need less
    auto result = run_in_batches(pipeline_, given.here, given.body_pairs, batches_);
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
