// SPDX-License-Identifier: MIT
#include "algorithms/resident_session.h"

#include "algorithms/batches.h"

#include <utility>

namespace tandem {

void ResidentSession::take(const Share& share) {
    stale_ = true; // bodies new to the share have no poses here
    steps_.bodies->take(share);
    steps_.steps.hierarchy->take(share, steps_.bodies->count());
    steps_.body_pairs->take(share);
}

void ResidentSession::do_reset() {
    steps_.body_pairs->reset();
    batches_ = 1;
}

/// Bodies and hierarchy as the frame has them; also those that do not move, unless a frame with them is known
/// to have run.
void ResidentSession::refresh(const Frame& frame) {
    const bool all = std::exchange(stale_, true);
    steps_.bodies->update(frame, all);
    steps_.steps.hierarchy->refit(frame, all);
}

/// The frame's commands from body pairs to contacts.
void ResidentSession::launch(const AnswerBuffers& answer) {
    steps_.status.begin(steps_.body_pairs->on_host().size());
    steps_.body_pairs->launch(steps_.status);
    const auto task = steps_.task(answer);
    if (task.most_pairs() == 0) return;
    steps_.steps.walker->launch(task);
    if (steps_.makes_contacts()) steps_.contacts->launch(answer, 0, answer.pairs.rows(), steps_.status);
}

/// Makes room for what the status counts; true when the frame has to run again.
bool ResidentSession::grow(AnswerBuffers& answer) {
    const auto& status = steps_.status;
    bool again = steps_.steps.walker->grow(status);
    again |= steps_.body_pairs->grow(status);
    if (const auto found = status.counter(STATUS_PAIRS);
        steps_.output == Output::pairs && found > answer.pairs.rows()) {
        answer.pairs.grow(found);
        again = true;
    }
    if (const auto contacts = status.counter(STATUS_CONTACTS);
        steps_.makes_contacts()
        && contacts > std::min(answer.contact_ids.rows(), answer.contact_values.rows())) {
        answer.contact_ids.grow(contacts);
        answer.contact_values.grow(contacts);
        again = true;
    }
    return again;
}

/// Everything of a frame up to its one wait, as one submission unless the device would be idle meanwhile.
void ResidentSession::begin(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs,
                            const AnswerBuffers& answer) {
    const auto all = [&] {
        refresh(frame);
        steps_.body_pairs->begin(frame, body_pairs);
        launch(answer);
        steps_.status.read();
    };
    if (steps_.settings[parameters::submission] == Submission::one
        && !steps_.body_pairs->works_on_host(body_pairs.has_value()))
        steps_.device.as_one(all);
    else
        all();
    stale_ = false;
}

FrameResult ResidentSession::run_whole(const Frame& frame,
                                       std::optional<std::span<const BodyPair>> body_pairs) {
    auto answer = steps_.answers->take();
    begin(frame, body_pairs, *answer);
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

FrameResult ResidentSession::do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) {
    try {
        if (batches_ == 1) return run_whole(frame, body_pairs);
    } catch (const OutOfMemory&) {
        batches_ = 2;
    }
    refresh(frame); // how far the frame came is not known
    try {
        steps_.body_pairs->begin(frame, body_pairs);
    } catch (const OutOfMemory&) {} // its parts need less
    auto result = run_in_batches(steps_, frame, body_pairs, batches_);
    stale_ = false;
    return result;
}

} // namespace tandem
