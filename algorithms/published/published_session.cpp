// SPDX-License-Identifier: MIT
#include "algorithms/published/published_session.h"

#include "algorithms/pipeline/batches.h"
#include "algorithms/pipeline/pipeline.h"
#include "algorithms/published/published_frame.h"

#include <algorithm>

namespace tandem {

namespace {

/// Makes contacts after every part of a walk and reads them back at once.
class ContactsBetween final : public LaunchHook {
public:
    ContactsBetween(Pipeline& pipeline, const AnswerBuffers& answer) : pipeline_(pipeline), answer_(answer) {}

    void part_walked() override;

private:
    void read_new(std::uint64_t contacts);

    Pipeline& pipeline_;
    const AnswerBuffers& answer_;
    std::uint64_t pairs_ = 0, contacts_ = 0; ///< pairs with finished contacts; contacts on the host
};

/// The release makes contacts after every level or batch, and reads them back at once.
void ContactsBetween::part_walked() {
    pipeline_.status.read();
    const auto found = pipeline_.status.counter(STATUS_PAIRS);
    const std::uint64_t written = std::min<std::uint64_t>(found, answer_.pairs.capacity());
    if (written > pairs_ && pipeline_.makes_contacts()) {
        pipeline_.contacts->launch(answer_.pairs.buffer(), ContactRows(answer_), pairs_,
                                   answer_.pairs.capacity(), pipeline_.status);
        pipeline_.status.read();
        read_new(
            std::min<std::uint64_t>(pipeline_.status.counter(STATUS_CONTACTS), answer_.contacts.capacity()));
    }
    pairs_ = written;
}

void ContactsBetween::read_new(std::uint64_t contacts) {
    if (contacts <= contacts_) return;
    const StageScope scope(pipeline_.device, Stage::read);
    for (const auto column : {contact_values, contact_ids}) {
        const auto row_bytes = answer_.contacts.row_bytes(column);
        std::vector<std::byte> bytes((contacts - contacts_) * row_bytes);
        pipeline_.device.download(answer_.contacts.buffer(column), bytes, contacts_ * row_bytes);
    }
    contacts_ = contacts;
}

class PublishedSession final : public Session {
public:
    PublishedSession(const Traversal& traversal, Device& device, const Scene& scene, Settings fitted)
        : pipeline_(traversal, device, scene, std::move(fitted)),
          frame_(*pipeline_.bodies, dynamic_cast<ChunkTrees&>(*pipeline_.stages.hierarchy), pipeline_.shape,
                 pipeline_.settings),
          devices_{&device} {}

private:
    void do_reset() override {}
    FrameResult do_run(const FrameInput& input, std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override { pipeline_.count(on); }
    std::span<Device* const> do_devices() const override { return devices_; }
    const Settings& do_settings() const override { return pipeline_.settings; }

    FrameResult run_whole();
    void walk(const AnswerBuffers& answer);
    bool grow(AnswerBuffers& answer);
    void sort_contacts(const AnswerBuffers& answer, std::uint64_t count);

    Pipeline pipeline_;
    PublishedFrame frame_;
    std::array<Device*, 1> devices_;
    std::uint64_t batches_ = 1; ///< number of parts with which frames start
};

void PublishedSession::walk(const AnswerBuffers& answer) {
    ContactsBetween between(pipeline_, answer);
    const auto task = pipeline_.task(answer, &between);
    pipeline_.status.begin(task.on_host.size());
    if (task.most_pairs() > 0) pipeline_.stages.walker->launch(task);
    pipeline_.status.read();
}

/// Grows buffers to what the status counts. Returns true if the walk must start again.
bool PublishedSession::grow(AnswerBuffers& answer) {
    bool again = pipeline_.stages.walker->grow(pipeline_.status);
    const auto found = pipeline_.status.counter(STATUS_PAIRS);
    if (has_pairs(pipeline_.output) && found > answer.pairs.capacity()) {
        answer.pairs.grow(found);
        again = true;
    }
    const auto contacts = pipeline_.status.counter(STATUS_CONTACTS);
    if (pipeline_.makes_contacts() && contacts > answer.contacts.capacity()) {
        answer.contacts.grow(contacts);
        again = true;
    }
    return again;
}

/// As in the original, sorts the contacts that were read back by pair and position, on one thread.
void PublishedSession::sort_contacts(const AnswerBuffers& answer, std::uint64_t count) {
    if (!pipeline_.makes_contacts()) return;
    std::vector<std::array<std::uint32_t, 2>> ids(count);
    {
        const StageScope scope(pipeline_.device, Stage::read);
        pipeline_.device.download(answer.contacts.buffer(contact_ids),
                                  std::as_writable_bytes(std::span(ids)));
    }
    const HostWork work(pipeline_.device, Stage::postprocess, "sort contacts");
    std::sort(ids.begin(), ids.end());
}

FrameResult PublishedSession::run_whole() {
    auto answer = pipeline_.answers->take();
    std::uint64_t retries = 0;
    for (walk(*answer); grow(*answer); walk(*answer)) ++retries;
    auto result = pipeline_.counts(pipeline_.status.words());
    result.retries = retries;
    if (pipeline_.counting) pipeline_.stages.walker->report(pipeline_.status, result.work);
    sort_contacts(*answer, result.contacts);
    pipeline_.add_part(result, std::move(answer));
    return result;
}

/// A frame that does not fit is walked in parts, as the release launches again with the rest of a full
/// buffer. Each part gets its contacts before the next one is walked. Phases have the release's names.
FrameResult PublishedSession::do_run(const FrameInput& input,
                                     std::optional<std::span<const BodyPair>> body_pairs) {
    {
        const HostPhase phase(pipeline_.device, "initialization");
        frame_.initialize(input.frame);
    }
    auto& pairs = *pipeline_.body_pairs;
    std::vector<BodyPair> too_many; // for the device's memory
    try {
        pairs.begin(input, body_pairs);
    } catch (const OutOfMemory&) {
        batches_ = std::max<std::uint64_t>(batches_, 2);
        too_many = body_pairs ? std::vector(body_pairs->begin(), body_pairs->end())
                              : pairs.list(&input, pipeline_.status);
    }
    const HostPhase phase(pipeline_.device, "narrow phase");
    frame_.prepare_walk(too_many.empty() ? pairs.on_host() : std::span<const BodyPair>(too_many));
    try {
        if (batches_ == 1) return run_whole();
    } catch (const OutOfMemory&) {
        batches_ = 2;
    }
    return run_in_batches(pipeline_, &input, body_pairs, batches_);
}

} // namespace

std::unique_ptr<Session> published_session(const Traversal& traversal, Device& device, const Scene& scene,
                                           Settings fitted) {
    return std::make_unique<PublishedSession>(traversal, device, scene, std::move(fitted));
}

} // namespace tandem
