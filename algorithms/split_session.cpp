// SPDX-License-Identifier: MIT
#include "algorithms/split_session.h"

#include "algorithms/bounds/geometry.h"
#include "algorithms/broad/broad.h"
#include "algorithms/resident_session.h"
#include "scenes/parallel.h"

namespace tandem {

namespace {

void add(FrameResult& sum, FrameResult& part, std::span<const Counter> counters) {
    sum.count += part.count;
    sum.contacts += part.contacts;
    sum.degenerate += part.degenerate;
    sum.rejected += part.rejected;
    sum.undecided_by_filter += part.undecided_by_filter;
    sum.undecided_by_double += part.undecided_by_double;
    sum.retries += part.retries;
    sum.batches += part.batches;
    for (const auto& counter : counters)
        if (part.work.contains(counter.name)) sum.work[counter.name] += part.work[counter.name];
    if (part.summed) {
        if (!sum.summed) sum.summed.emplace();
        *sum.summed += *part.summed;
    }
    std::move(part.parts.begin(), part.parts.end(), std::back_inserter(sum.parts));
}

class SplitSession final : public Session {
public:
    SplitSession(const Traversal& traversal, std::span<Device* const> devices, const Scene& scene,
                 std::vector<Settings> fitted);

private:
    void do_reset() override {
        for (const auto& session : sessions_) session->reset();
    }
    FrameResult do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override {
        for (const auto& session : sessions_) session->count_work(on);
    }
    std::span<Device* const> do_devices() const override { return devices_; }
    const Settings& do_settings() const override { return sessions_.front()->settings(); }

    const Traversal& traversal_;
    std::vector<Device*> devices_;
    std::vector<std::unique_ptr<Session>> sessions_;
    std::optional<BroadSweep> broad_;
};

SplitSession::SplitSession(const Traversal& traversal, std::span<Device* const> devices, const Scene& scene,
                           std::vector<Settings> fitted)
    : traversal_(traversal), devices_(devices.begin(), devices.end()) {
    for (std::size_t i = 0; i < devices.size(); ++i) {
        if (fitted[i][parameters::broad] == Broad::device) fitted[i].set(parameters::broad(Broad::tight));
        sessions_.push_back(resident_session(traversal, *devices[i], scene, fitted[i]));
    }
    broad_.emplace(scene, geometry_of(settings()), settings()[parameters::broad]);
}

FrameResult SplitSession::do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) {
    std::vector<BodyPair> found;
    if (!body_pairs) {
        const HostWork work(*devices_.front(), Stage::broad, "body pairs");
        found = broad_->pairs(frame);
    }
    const auto pairs = body_pairs ? *body_pairs : std::span<const BodyPair>(found);
    std::vector<FrameResult> parts(sessions_.size());
    parallel_for(sessions_.size(), sessions_.size(), [&](std::size_t i) {
        const auto first = pairs.size() * i / sessions_.size();
        const auto end = pairs.size() * (i + 1) / sessions_.size();
        parts[i] = sessions_[i]->run(frame, pairs.subspan(first, end - first));
    });
    FrameResult sum;
    for (auto& part : parts) add(sum, part, traversal_.counters());
    sum.body_pairs = pairs.size();
    return sum;
}

} // namespace

std::unique_ptr<Session> split_session(const Traversal& traversal, std::span<Device* const> devices,
                                       const Scene& scene, std::vector<Settings> fitted) {
    return std::make_unique<SplitSession>(traversal, devices, scene, std::move(fitted));
}

} // namespace tandem
