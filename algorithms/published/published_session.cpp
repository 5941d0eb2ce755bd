// SPDX-License-Identifier: MIT
#include "algorithms/published/published_session.h"

#include "algorithms/batches.h"
#include "algorithms/pipeline.h"
#include "algorithms/published/published_frame.h"

#include <algorithm>

namespace tandem {

namespace {

/// Makes contacts after every part of a walk and brings them to the host at once.
class ContactsBetween final : public LaunchHook {
public:
    ContactsBetween(Pipeline& steps, const AnswerBuffers& answer) : steps_(steps), answer_(answer) {}

    void part_walked() override;

private:
    void read_new(std::uint64_t contacts);

    Pipeline& steps_;
    const AnswerBuffers& answer_;
    std::uint64_t pairs_ = 0, contacts_ = 0; ///< whose contacts are made; that are on the host
};

/// The release made contacts after every level or batch, and read them back at once.
void ContactsBetween::part_walked() {
    steps_.status.read();
    const auto found = steps_.status.counter(STATUS_PAIRS);
    const std::uint64_t written = std::min<std::uint64_t>(found, answer_.pairs.capacity());
    if (written > pairs_ && steps_.makes_contacts()) {
        steps_.contacts->launch(answer_, pairs_, answer_.pairs.capacity(), steps_.status);
        steps_.status.read();
        read_new(
            std::min<std::uint64_t>(steps_.status.counter(STATUS_CONTACTS), answer_.contacts.capacity()));
    }
    pairs_ = written;
}

void ContactsBetween::read_new(std::uint64_t contacts) {
    if (contacts <= contacts_) return;
    const StageScope scope(steps_.device, Stage::read);
    for (const auto column : {contact_values, contact_ids}) {
        const auto row_bytes = answer_.contacts.row_bytes(column);
        std::vector<std::byte> bytes((contacts - contacts_) * row_bytes);
        steps_.device.download(answer_.contacts.buffer(column), bytes, contacts_ * row_bytes);
    }
    contacts_ = contacts;
}

class PublishedSession final : public Session {
public:
    PublishedSession(const Traversal& traversal, Device& device, const Scene& scene, Settings fitted)
        : steps_(traversal, device, scene, std::move(fitted)),
          frame_(*steps_.bodies, *steps_.steps.hierarchy, steps_.shape, steps_.settings[parameters::convert],
                 static_cast<std::uint32_t>(steps_.settings[parameters::threads])),
          devices_{&device} {}

private:
    void do_reset() override { steps_.body_pairs->reset(); }
    FrameResult do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override { steps_.count(on); }
    std::span<Device* const> do_devices() const override { return devices_; }
    const Settings& do_settings() const override { return steps_.settings; }

    FrameResult run_whole();
    void walk(const AnswerBuffers& answer);
    bool grow(AnswerBuffers& answer);
    void sort_contacts(const AnswerBuffers& answer, std::uint64_t count);

    Pipeline steps_;
    PublishedFrame frame_;
    std::array<Device*, 1> devices_;
    std::uint64_t batches_ = 1; ///< parts that frames begin with
};

void PublishedSession::walk(const AnswerBuffers& answer) {
    ContactsBetween between(steps_, answer);
    const auto task = steps_.task(answer, &between);
    steps_.status.begin(task.on_host.size());
    if (task.most_pairs() > 0) steps_.steps.walker->launch(task);
    steps_.status.read();
}

/// Makes room for what the status counts; true when the walk has to start again.
bool PublishedSession::grow(AnswerBuffers& answer) {
    bool again = steps_.steps.walker->grow(steps_.status);
    const auto found = steps_.status.counter(STATUS_PAIRS);
    if (steps_.output == Output::pairs && found > answer.pairs.capacity()) {
        answer.pairs.grow(found);
        again = true;
    }
    const auto contacts = steps_.status.counter(STATUS_CONTACTS);
    if (steps_.makes_contacts() && contacts > answer.contacts.capacity()) {
        answer.contacts.grow(contacts);
        again = true;
    }
    return again;
}

/// The original sorts the contacts it read back by pair and position, on one thread (prox.md 2.12).
void PublishedSession::sort_contacts(const AnswerBuffers& answer, std::uint64_t count) {
    if (!steps_.makes_contacts()) return;
    std::vector<std::array<std::uint32_t, 2>> ids(count);
    {
        const StageScope scope(steps_.device, Stage::read);
        steps_.device.download(answer.contacts.buffer(contact_ids), std::as_writable_bytes(std::span(ids)));
    }
    const HostWork work(steps_.device, Stage::postprocess, "sort contacts");
    std::sort(ids.begin(), ids.end());
}

FrameResult PublishedSession::run_whole() {
    auto answer = steps_.answers->take();
    std::uint64_t retries = 0;
    for (walk(*answer); grow(*answer); walk(*answer)) ++retries;
    auto result = steps_.counts();
    result.retries = retries;
    if (steps_.counting) steps_.steps.walker->report(steps_.status, result.work);
    sort_contacts(*answer, result.contacts);
    steps_.add_part(result, std::move(answer));
    return result;
}

/// A frame that does not fit is walked in parts, as the release launches again with what is left of a full
/// buffer; each part has its contacts before the next is walked.
FrameResult PublishedSession::do_run(const Frame& frame,
                                     std::optional<std::span<const BodyPair>> body_pairs) {
    frame_.update(frame);
    try {
        steps_.body_pairs->begin(frame, body_pairs);
        if (batches_ == 1) return run_whole();
    } catch (const OutOfMemory&) {
        batches_ = std::max<std::uint64_t>(batches_, 2);
    }
    return run_in_batches(steps_, &frame, body_pairs, batches_);
}

} // namespace

std::unique_ptr<Session> published_session(const Traversal& traversal, Device& device, const Scene& scene,
                                           Settings fitted) {
    return std::make_unique<PublishedSession>(traversal, device, scene, std::move(fitted));
}

} // namespace tandem
