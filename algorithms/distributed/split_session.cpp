// SPDX-License-Identifier: MIT
#include "algorithms/distributed/split_session.h"

#include "algorithms/parameters/table.h"
#include "algorithms/pipeline/resident_session.h"
#include "algorithms/distributed/repartition_loop.h"
#include "base/parallel.h"

#include <chrono>

namespace tandem {

namespace {

using Clock = std::chrono::steady_clock;

void add(FrameResult& sum, FrameResult& part, std::span<const Counter> counters) {
    sum.add(part, part.summed);
    for (const auto& counter : counters)
        if (part.work.contains(counter.name)) sum.work[counter.name] += part.work[counter.name];
    std::move(part.parts.begin(), part.parts.end(), std::back_inserter(sum.parts));
}

class SplitSession final : public Session {
public:
    SplitSession(const Traversal& traversal, std::span<Device* const> devices, const Scene& scene,
                 const std::vector<Settings>& fitted);

private:
    void do_reset() override {
        for (const auto& session : sessions_) session->reset();
    }
    void do_move_origin() override {
        has_moved_ = true;
        for (const auto& session : sessions_) session->forget_places();
    }
    FrameResult do_run(const FrameInput& input, std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override {
        for (const auto& session : sessions_) session->count_work(on);
    }
    std::span<Device* const> do_devices() const override { return devices_; }
    const Settings& do_settings() const override { return sessions_.front()->settings(); }

    bool repartition_if_needed(const FrameInput& input);
    void apply_subdomains();
    void distribute_pairs(std::span<const BodyPair> body_pairs);
    FrameResult run_subdomain(std::size_t i, const FrameInput& input, bool has_given_pairs);
    void add_sample(const FrameResult& result);

    const Traversal& traversal_;
    std::vector<Device*> devices_;
    std::vector<std::unique_ptr<ResidentSession>> sessions_;
    std::optional<BroadSweep> broad_; ///< where the host finds body pairs
    RepartitionLoop partition_;
    bool has_moved_ = false;                             ///< the partition is of another origin
    std::vector<Subdomain> subdomains_;                  ///< by device
    std::vector<bool> is_applied_;                       ///< by device: its session has its subdomain
    std::vector<std::vector<Role>> roles_;               ///< by device and body, of subdomains_
    std::vector<std::vector<BodyPair>> pairs_by_device_; ///< pairs that the host distributes
};

SplitSession::SplitSession(const Traversal& traversal, std::span<Device* const> devices, const Scene& scene,
                           const std::vector<Settings>& fitted)
    : traversal_(traversal),
      devices_(devices.begin(), devices.end()),
      partition_(scene, fitted.front(), devices.size()),
      subdomains_(devices.size()),
      is_applied_(devices.size()),
      roles_(devices.size(), std::vector<Role>(scene.bodies.size(), Role::none)),
      pairs_by_device_(devices.size()) {
    for (std::size_t i = 0; i < devices.size(); ++i)
        sessions_.push_back(std::make_unique<ResidentSession>(traversal, *devices[i], scene, fitted[i]));
    if (const auto method = settings()[parameters::broad]; method != Broad::device)
        broad_.emplace(scene, geometry_of(settings()), method, settings()[parameters::self]);
}

/// Repartitions the bodies when the partition is invalid or the load is unbalanced. Returns whether it did.
bool SplitSession::repartition_if_needed(const FrameInput& input) {
    const bool is_new = partition_.is_due(input) || has_moved_;
    if (is_new) {
        const HostWork work(*devices_.front(), Stage::broad, "partition bodies");
        partition_.repartition(input.frame);
        has_moved_ = false;
        // A new partition can expire on the path to the frame's successor. The skin of the next one is
        // larger.
        while (input.next != nullptr && partition_.is_due(input)) partition_.repartition(input.frame);
        for (std::size_t i = 0; i < sessions_.size(); ++i) {
            sessions_[i]->expect(partition_.partitioner().expected_pairs(i), partition_.contacts_a_pair());
            subdomains_[i] = partition_.subdomains()[i];
            roles_[i] = roles_of(subdomains_[i], roles_[i].size());
            is_applied_[i] = false;
        }
    }
    apply_subdomains();
    return is_new;
}

/// Passes subdomains to the sessions that do not have them. A failure in one frame may leave some for the
/// next.
void SplitSession::apply_subdomains() {
    for (std::size_t i = 0; i < sessions_.size(); ++i) {
        if (is_applied_[i]) continue;
        sessions_[i]->set_subdomain(subdomains_[i]);
        is_applied_[i] = true;
    }
}

/// Distributes pairs by the owners of their bodies. Pairs passed to run() may have any bodies; a subdomain
/// that lacks one gets it as a ghost.
void SplitSession::distribute_pairs(std::span<const BodyPair> body_pairs) {
    for (auto& pairs : pairs_by_device_) pairs.clear();
    for (const auto& pair : body_pairs) {
        const auto i = std::min(partition_.partitioner().subdomain_of(pair), sessions_.size() - 1);
        pairs_by_device_[i].push_back(pair);
        for (const auto body : {pair.a, pair.b}) {
            if (roles_[i][body] != Role::none) continue;
            roles_[i][body] = Role::ghost;
            subdomains_[i].ghosts.push_back(body);
            is_applied_[i] = false;
        }
    }
    apply_subdomains();
}

FrameResult SplitSession::run_subdomain(std::size_t i, const FrameInput& input, bool has_given_pairs) {
    const auto begin = Clock::now();
    auto result = has_given_pairs ? sessions_[i]->run(FrameView(input).checked(), pairs_by_device_[i])
                                  : sessions_[i]->run(FrameView(input).checked());
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
    result.shared = {
        {subdomains_[i].own.size() + subdomains_[i].ghosts.size(), result.body_pairs, result.count, ns}};
    return result;
}

void SplitSession::add_sample(const FrameResult& result) {
    if (result.retries > 0 || result.batches > sessions_.size()) return; // its times are not representative
    partition_.add_sample(result, [&] {
        std::vector<std::uint64_t> counts;
        if (result.has_pairs())
            for (const auto& part : result.parts) part->count_by_body(counts);
        counts.resize(roles_.front().size());
        return counts;
    });
}

FrameResult SplitSession::do_run(const FrameInput& input,
                                 std::optional<std::span<const BodyPair>> body_pairs) {
    const bool is_new = repartition_if_needed(input);
    std::vector<BodyPair> found;
    if (!body_pairs && broad_) {
        const HostWork work(*devices_.front(), Stage::broad, "body pairs");
        found = broad_->pairs(input);
        body_pairs = found;
    }
    if (body_pairs) distribute_pairs(*body_pairs);
    std::vector<FrameResult> parts(sessions_.size());
    parallel_for(sessions_.size(), sessions_.size(),
                 [&](std::size_t i) { parts[i] = run_subdomain(i, input, body_pairs.has_value()); });
    FrameResult sum;
    for (auto& part : parts) {
        sum.shared.push_back(part.shared.front());
        add(sum, part, traversal_.counters());
    }
    sum.repartitions = is_new ? 1 : 0;
    add_sample(sum);
    return sum;
}

} // namespace

std::unique_ptr<Session> split_session(const Traversal& traversal, std::span<Device* const> devices,
                                       const Scene& scene, const std::vector<Settings>& fitted) {
    return std::make_unique<SplitSession>(traversal, devices, scene, fitted);
}

} // namespace tandem
