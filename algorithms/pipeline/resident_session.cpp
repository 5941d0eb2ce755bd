// SPDX-License-Identifier: MIT
#include "algorithms/pipeline/resident_session.h"

#include "algorithms/pipeline/batches.h"
#include "algorithms/bodies/frame_on_device.h"

#include <fmt/format.h>
#include <utility>

namespace tandem {

void ResidentSession::set_subdomain(const Subdomain& subdomain) {
    stale_ = true;  // new bodies of the subdomain have no poses on the device
    poses_.reset(); // the host packs the poses of the subdomain alone
    pipeline_.bodies->set_subdomain(subdomain);
    pipeline_.stages.hierarchy->take(subdomain, pipeline_.bodies->count());
    pipeline_.body_pairs->set_subdomain(subdomain);
}

void ResidentSession::set_received(std::span<const std::uint32_t> bodies) {
    has_received_ = !bodies.empty();
    is_uploaded_ = false;
    pipeline_.bodies->exclude_from_upload(bodies);
}

void ResidentSession::upload_vertices(const Frame& frame) {
    pipeline_.bodies->update_deformed(frame, true);
    is_uploaded_ = true;
}

void ResidentSession::do_reset() {
    batches_ = 1;
    pipeline_.stages.walker->reset();
}

FrameResult ResidentSession::do_run_device_input(const DeviceFrameInput& input,
                                                 std::optional<std::span<const BodyPair>> body_pairs) {
    if (!pack_) pack_ = std::make_unique<PackStage>(*pipeline_.bodies, pipeline_.shape);
    return run_input({.device = &input, .body_pairs = body_pairs});
}

/// Updates bodies and hierarchy to the frame. Fixed bodies are included unless an earlier frame has updated
/// them successfully.
void ResidentSession::refresh(const Input& input) {
    const bool all = std::exchange(stale_, true);
    if (input.host != nullptr) {
        if (poses_)
            poses_->launch(input.host->frame, all);
        else
            pipeline_.bodies->update_poses(*input.host, all);
        if (!std::exchange(is_uploaded_, false)) pipeline_.bodies->update_deformed(*input.host);
        pipeline_.stages.hierarchy->refit(input.host->frame, all);
        return;
    }
    // NOLINTNEXTLINE(clang-analyzer-core.NonNullParamChecker): one of the two frames is given
    pack_->launch(*input.device, origin(), pipeline_.status.buffer());
    pipeline_.stages.hierarchy->refit({.poses = {}, .deformed = {}, .skipped = input.device->frame.skipped},
                                      all);
}

void ResidentSession::find_body_pairs(const Input& input) {
    if (input.host != nullptr)
        pipeline_.body_pairs->begin(*input.host, input.body_pairs);
    else
        pipeline_.body_pairs->begin_on_device(input.body_pairs);
}

/// Whether the host works or waits between the frame's commands, so that a single submission would leave the
/// device idle.
bool ResidentSession::waits_within_frame(const Input& input) const {
    const bool has_pairs = input.body_pairs.has_value();
    return input.host != nullptr ? pipeline_.body_pairs->works_on_host(has_pairs)
                                 : pipeline_.body_pairs->sorts_on_device(has_pairs);
}

/// Throws InputError if packing has counted rows out of range; the bounds of their bodies are wrong.
void ResidentSession::reject_flaws(const Input& input) {
    if (input.device == nullptr) return;
    const auto flawed = pipeline_.status.counter(STATUS_FLAWED);
    if (flawed == 0) return;
    stale_ = true;
    refuse_flawed(pipeline_.device, scene_, *input.device, pipeline_.bodies->geometry(), flawed);
}

/// Enqueues the frame's commands from body pairs to contacts.
void ResidentSession::launch(const AnswerBuffers& answer) {
    pipeline_.status.begin(pipeline_.body_pairs->on_host().size());
    walk(answer);
}

/// The same after Status::begin().
void ResidentSession::walk(const AnswerBuffers& answer) {
    pipeline_.body_pairs->launch(pipeline_.status);
    const auto task = pipeline_.task(answer);
    if (task.most_pairs() == 0) return;
    pipeline_.stages.walker->launch(task);
    if (pipeline_.order) pipeline_.order->sort_pairs(answer, pipeline_.status);
    if (!pipeline_.makes_contacts()) return;
    const auto kept = pipeline_.order ? pipeline_.order->unsorted(answer) : ContactRows(answer);
    const auto made = pipeline_.reduction ? pipeline_.reduction->source(answer) : kept;
    pipeline_.contacts->launch(answer.pairs.buffer(), made, 0, answer.pairs.capacity(), pipeline_.status);
    if (pipeline_.reduction) pipeline_.reduction->launch(answer, kept, task.pair_capacity, pipeline_.status);
    if (pipeline_.order)
        pipeline_.order->sort_contacts(answer, pipeline_.reduction != nullptr, pipeline_.status);
}

/// Grows all buffers to the counts of the status. Returns true if the walk must run again.
bool ResidentSession::grow(AnswerBuffers& answer) {
    const auto& status = pipeline_.status;
    bool again = pipeline_.stages.walker->grow(status);
    again |= pipeline_.body_pairs->grow(status);
    if (const auto found = status.counter(STATUS_PAIRS);
        has_pairs(pipeline_.output) && found > answer.pairs.capacity()) {
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

/// Enqueues all commands of a frame, as one submission if the host does not interrupt them, and `end` at the
/// end. Packing counts in the status, so that Status::begin() comes first.
template<class End>
void ResidentSession::submit(const Input& input, const AnswerBuffers& answer, const End& end) {
    const auto all = [&] {
        if (input.device != nullptr) pipeline_.status.begin(input.body_pairs ? input.body_pairs->size() : 0);
        refresh(input);
        find_body_pairs(input);
        if (input.device != nullptr)
            walk(answer);
        else
            launch(answer);
        end();
    };
    if (pipeline_.settings[parameters::submission] == Submission::one && !waits_within_frame(input))
        pipeline_.device.as_one(all);
    else
        all();
    stale_ = false;
}

/// Enqueues a frame up to its only wait, and waits.
void ResidentSession::begin(const Input& input, const AnswerBuffers& answer) {
    submit(input, answer, [&] { pipeline_.status.read(); });
    reject_flaws(input);
}

FrameResult ResidentSession::run_whole(const Input& input) {
    auto answer = pipeline_.answers->take();
    begin(input, *answer);
    std::uint64_t retries = 0;
    for (;; ++retries) {
        if (pipeline_.contacts) pipeline_.contacts->expect(pipeline_.status.counter(STATUS_PAIRS));
        if (!grow(*answer)) break;
        launch(*answer);
        pipeline_.status.read();
    }
    if (retries > 0) queued_.reset();
    auto result = pipeline_.counts(pipeline_.status.words());
    result.retries = retries;
    if (pipeline_.counting) pipeline_.stages.walker->report(pipeline_.status, result.work);
    pipeline_.add_part(result, std::move(answer));
    return result;
}

/// Runs the frame in batches, from the start, because the state after a failed run is unknown.
FrameResult ResidentSession::run_parts(const Input& input) {
    if (has_received_)
        throw OutOfMemory(fmt::format("{}: a frame in batches needs all vertices in the host's memory",
                                      pipeline_.device.info().id));
    if (input.device != nullptr) pipeline_.status.begin(0);
    refresh(input);
    if (input.device != nullptr) {
        pipeline_.status.read();
        reject_flaws(input);
    }
    try {
        find_body_pairs(input);
    } catch (const OutOfMemory&) {} // batches need less memory
    queued_.reset();
    auto result = run_in_batches(pipeline_, input.host, input.body_pairs, batches_);
    stale_ = false;
    return result;
}

FrameResult ResidentSession::run_input(const Input& input) {
    try {
        if (batches_ == 1) return run_whole(input);
    } catch (const OutOfMemory&) {
        batches_ = 2;
    }
    return run_parts(input);
}

/// The limits of all buffers but those of the answer.
std::vector<Limit> ResidentSession::limits() const {
    const auto& settings = pipeline_.settings;
    if (settings[parameters::decision] == DecisionPrecision::exact && pipeline_.contacts)
        throw InputError(
            "setting decision=exact decides some pairs on the host, which enqueue() does not wait "
            "for; choose decision=recheck, or call run()");
    auto limits = pipeline_.stages.walker->limits();
    if (!limits)
        throw InputError(
            "this algorithm's schedule needs the host in every frame; choose tiled for enqueue(), "
            "or call run()");
    limits->push_back({STATUS_BODY_PAIRS, pipeline_.body_pairs->rows().capacity()});
    return *std::move(limits);
}

/// Runs the frame as run() does, so that every buffer of frames of its kind exists, and every kernel.
void ResidentSession::prepare_queued(const Input& input) {
    if (!queued_) queued_.emplace(pipeline_.answers->take());
    if (input.device != nullptr && !pack_)
        pack_ = std::make_unique<PackStage>(*pipeline_.bodies, pipeline_.shape);
    const auto& answer = *queued_->answer;
    begin(input, answer);
    pipeline_.stages.walker->grow(pipeline_.status); // it also expects as many pairs in the next frame
    if (pipeline_.contacts) {
        pipeline_.contacts->expect(pipeline_.status.counter(STATUS_PAIRS));
        pipeline_.contacts->reserve(answer.pairs.capacity());
    }
    if (!queued_->end)
        queued_->end = std::make_unique<QueuedStage>(*pipeline_.bodies, pipeline_.shape, queued_->answer,
                                                     has_pairs(pipeline_.output));
    queued_->end->set_limits(limits());
    queued_->kinds |= input.kind();
    queued_->memory.reset();
}

/// Enqueues the frame. Returns what holds the memory that its commands use.
std::shared_ptr<const void> ResidentSession::hold_and_submit(const Input& input) {
    const auto held =
        std::make_shared<std::pair<std::shared_ptr<const AnswerBuffers>, std::vector<Buffer>>>();
    held->first = queued_->answer;
    pipeline_.device.hold_buffers(&held->second);
    try {
        submit(input, *queued_->answer, [&] { queued_->end->launch(pipeline_.status); });
    } catch (...) {
        pipeline_.device.hold_buffers(nullptr);
        throw;
    }
    pipeline_.device.hold_buffers(nullptr);
    return held;
}

QueuedFrame ResidentSession::do_enqueue(const FrameInput* host, const DeviceFrameInput* device,
                                        std::optional<std::span<const BodyPair>> body_pairs) {
    const Input input{.host = host, .device = device, .body_pairs = body_pairs};
    const bool is_captured = pipeline_.device.is_captured();
    const bool has_room = !body_pairs || body_pairs->size() <= pipeline_.body_pairs->rows().capacity();
    if (!queued_ || stale_ || (queued_->kinds & input.kind()) == 0 || !has_room) {
        if (is_captured) refuse_capture();
        limits(); // refuses before anything runs
        prepare_queued(input);
    }
    auto frame = queued_->end->frame();
    if (is_captured || !queued_->memory) { // a captured frame may take other kernels than the one prepared
        frame.memory = hold_and_submit(input);
        if (!is_captured) queued_->memory = frame.memory;
    } else {
        submit(input, *queued_->answer, [&] { queued_->end->launch(pipeline_.status); });
        frame.memory = queued_->memory;
    }
    return frame;
}

std::optional<FrameResult> ResidentSession::do_collect() {
    if (!queued_ || !queued_->end) return Session::do_collect();
    const auto words = queued_->end->read();
    if (!words) return std::nullopt;
    auto result = pipeline_.counts(*words);
    pipeline_.add_part(result, queued_->answer);
    return result;
}

} // namespace tandem
