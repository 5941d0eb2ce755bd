// SPDX-License-Identifier: MIT
#include "algorithms/resident_session.h"

#include "algorithms/batches.h"
#include "algorithms/bodies/frame_on_device.h"
#include "algorithms/bodies/pack_stage.h"

#include <utility>

namespace tandem {

namespace {

/// A frame in the host's memory or in the device's, and the body pairs that were given with it.
struct Given {
    const Frame* here = nullptr;
    const DeviceFrame* there = nullptr;
    std::optional<std::span<const BodyPair>> body_pairs{};
};

class ResidentSession final : public Session {
public:
    ResidentSession(const Traversal& traversal, Device& device, const Scene& scene, Settings fitted)
        : scene_(scene), steps_(traversal, device, scene, std::move(fitted)), devices_{&device} {}

private:
    void do_reset() override;
    FrameResult do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) override {
        return run_given({.here = &frame, .body_pairs = body_pairs});
    }
    FrameResult do_run_there(const DeviceFrame& frame,
                             std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override { steps_.count(on); }
    std::span<Device* const> do_devices() const override { return devices_; }
    const Settings& do_settings() const override { return steps_.settings; }

    void refresh(const Given& given);
    void find_body_pairs(const Given& given);
    bool waits_on_way(const Given& given) const;
    void refuse_flaws(const Given& given);
    void launch(const AnswerBuffers& answer);
    void walk(const AnswerBuffers& answer);
    void begin(const Given& given, const AnswerBuffers& answer);
    bool grow(AnswerBuffers& answer);
    FrameResult run_whole(const Given& given);
    FrameResult run_parts(const Given& given);
    FrameResult run_given(const Given& given);

    const Scene& scene_;
    Pipeline steps_;
    std::array<Device*, 1> devices_;
    std::unique_ptr<PackStage> pack_; ///< from the first frame in the device's memory on
    std::uint64_t batches_ = 1;       ///< to begin a frame with
    bool stale_ = true;               ///< whether all commands so far have run is not known
};

void ResidentSession::do_reset() {
    steps_.body_pairs->reset();
    batches_ = 1;
}

FrameResult ResidentSession::do_run_there(const DeviceFrame& frame,
                                          std::optional<std::span<const BodyPair>> body_pairs) {
    if (!pack_) pack_ = std::make_unique<PackStage>(*steps_.bodies, steps_.shape);
    return run_given({.there = &frame, .body_pairs = body_pairs});
}

/// Bodies and hierarchy as the frame has them; also those that do not move, unless a frame with them is known
/// to have run.
void ResidentSession::refresh(const Given& given) {
    const bool all = std::exchange(stale_, true);
    if (given.here != nullptr) {
        steps_.bodies->update(*given.here, all);
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
        steps_.body_pairs->begin_there(given.body_pairs);
}

/// Whether the device would be idle while the host works or waits before the end of the frame's commands.
bool ResidentSession::waits_on_way(const Given& given) const {
    const bool has_pairs = given.body_pairs.has_value();
    return given.here != nullptr ? steps_.body_pairs->works_on_host(has_pairs)
                                 : steps_.body_pairs->sorts_there(has_pairs);
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
    if (steps_.settings[parameters::submission] == Submission::one && !waits_on_way(given))
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

} // namespace

std::unique_ptr<Session> resident_session(const Traversal& traversal, Device& device, const Scene& scene,
                                          Settings fitted) {
    return std::make_unique<ResidentSession>(traversal, device, scene, std::move(fitted));
}

} // namespace tandem
