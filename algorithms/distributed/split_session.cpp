// SPDX-License-Identifier: MIT
#include "algorithms/distributed/split_session.h"

#include "algorithms/parameters/table.h"
#include "algorithms/resident_session.h"
#include "algorithms/distributed/balance.h"
#include "algorithms/distributed/deal.h"
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
    FrameResult do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override {
        for (const auto& session : sessions_) session->count_work(on);
    }
    std::span<Device* const> do_devices() const override { return devices_; }
    const Settings& do_settings() const override { return sessions_.front()->settings(); }

    bool deal(const Frame& frame);
    void tell();
    void deal_pairs(std::span<const BodyPair> body_pairs);
    FrameResult run_share(std::size_t i, const Frame& frame, bool is_dealt_pairs);
    void look_back(const FrameResult& result);

    const Traversal& traversal_;
    std::vector<Device*> devices_;
    std::vector<std::unique_ptr<ResidentSession>> sessions_;
    std::optional<BroadSweep> broad_; ///< where the host finds body pairs
    Deal deal_;
    Balance balance_;
    double contacts_a_pair_ = 1;               ///< when frames were last out of balance
    std::vector<Share> taken_;                 ///< by device: what its session is to be told
    std::vector<bool> is_told_;                ///< by device
    std::vector<std::vector<Role>> roles_;     ///< by device and body, of taken_
    std::vector<std::vector<BodyPair>> dealt_; ///< by device: pairs that the host has dealt out
};

SplitSession::SplitSession(const Traversal& traversal, std::span<Device* const> devices, const Scene& scene,
                           const std::vector<Settings>& fitted)
    : traversal_(traversal),
      devices_(devices.begin(), devices.end()),
      deal_(scene, geometry_of(fitted.front()), devices.size()),
      balance_(devices.size()),
      taken_(devices.size()),
      is_told_(devices.size()),
      roles_(devices.size(), std::vector<Role>(scene.bodies.size(), Role::none)),
      dealt_(devices.size()) {
    for (std::size_t i = 0; i < devices.size(); ++i)
        sessions_.push_back(std::make_unique<ResidentSession>(traversal, *devices[i], scene, fitted[i]));
    if (const auto who = settings()[parameters::broad]; who != Broad::device)
        broad_.emplace(scene, geometry_of(settings()), who);
}

/// Deals the bodies anew where it has to be, or had better be; returns whether it has.
bool SplitSession::deal(const Frame& frame) {
    const bool is_new = !deal_.holds(frame) || balance_.wants_a_deal();
    if (is_new) {
        const HostWork work(*devices_.front(), Stage::broad, "deal bodies");
        deal_.make(frame, balance_.speeds());
        balance_.dealt();
        for (std::size_t i = 0; i < sessions_.size(); ++i) {
            sessions_[i]->expect(deal_.expected_pairs(i), contacts_a_pair_);
            taken_[i] = deal_.shares()[i];
            roles_[i] = roles_in(taken_[i], roles_[i].size());
            is_told_[i] = false;
        }
    }
    tell();
    return is_new;
}

/// Tells sessions their shares, also those that a failure has kept from it before.
void SplitSession::tell() {
    for (std::size_t i = 0; i < sessions_.size(); ++i) {
        if (is_told_[i]) continue;
        sessions_[i]->take(taken_[i]);
        is_told_[i] = true;
    }
}

/// Deals pairs out by who owns their bodies. Pairs that are given may be of any bodies: shares that lack one
/// get it.
void SplitSession::deal_pairs(std::span<const BodyPair> body_pairs) {
    for (auto& pairs : dealt_) pairs.clear();
    for (const auto& pair : body_pairs) {
        const auto i = std::min(deal_.share_of(pair), sessions_.size() - 1);
        dealt_[i].push_back(pair);
        for (const auto body : {pair.a, pair.b}) {
            if (roles_[i][body] != Role::none) continue;
            roles_[i][body] = Role::other;
            taken_[i].others.push_back(body);
            is_told_[i] = false;
        }
    }
    tell();
}

FrameResult SplitSession::run_share(std::size_t i, const Frame& frame, bool is_dealt_pairs) {
    const auto begin = Clock::now();
    auto result = is_dealt_pairs ? sessions_[i]->run(frame, dealt_[i]) : sessions_[i]->run(frame);
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
    result.shared = {{taken_[i].own.size() + taken_[i].others.size(), result.body_pairs, result.count, ns}};
    return result;
}

/// What the frame tells of the next deal.
void SplitSession::look_back(const FrameResult& result) {
    if (result.retries > 0 || result.batches > sessions_.size()) return; // they are not what frames take
    std::vector<double> work;
    for (std::size_t i = 0; i < result.shared.size(); ++i)
        work.push_back(deal_.work_of(i, result.shared[i].pairs));
    balance_.see(result.shared, work);
    if (!balance_.wants_a_deal() || !result.has_pairs()) return;
    contacts_a_pair_ = result.contacts_a_pair();
    std::vector<std::uint64_t> counts;
    for (const auto& part : result.parts) part->count_by_body(counts);
    counts.resize(roles_.front().size());
    deal_.learn(counts);
}

FrameResult SplitSession::do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) {
    const bool is_new = deal(frame);
    std::vector<BodyPair> found;
    if (!body_pairs && broad_) {
        const HostWork work(*devices_.front(), Stage::broad, "body pairs");
        found = broad_->pairs(frame);
        body_pairs = found;
    }
    if (body_pairs) deal_pairs(*body_pairs);
    std::vector<FrameResult> parts(sessions_.size());
    parallel_for(sessions_.size(), sessions_.size(),
                 [&](std::size_t i) { parts[i] = run_share(i, frame, body_pairs.has_value()); });
    FrameResult sum;
    for (auto& part : parts) {
        sum.shared.push_back(part.shared.front());
        add(sum, part, traversal_.counters());
    }
    sum.deals = is_new ? 1 : 0;
    look_back(sum);
    return sum;
}

} // namespace

std::unique_ptr<Session> split_session(const Traversal& traversal, std::span<Device* const> devices,
                                       const Scene& scene, const std::vector<Settings>& fitted) {
    return std::make_unique<SplitSession>(traversal, devices, scene, fitted);
}

} // namespace tandem
