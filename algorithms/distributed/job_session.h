// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "backends/ranks.h"

namespace tandem {

/// A session on all ranks of a job, composed of the session of each rank (RankSession). All its functions and
/// those of its results are collective. Counts and digests of a result are totals over all ranks, on every
/// rank. A download delivers pairs and contacts on rank 0 only.
class JobSession final : public Session {
public:
    /// `ranks` must outlive this and its results.
    JobSession(Ranks& ranks, std::unique_ptr<Session> own) : ranks_(ranks), own_(std::move(own)) {}

private:
    void do_reset() override { own_->reset(); }
    FrameResult do_run(const FrameInput& input, std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override { own_->count_work(on); }
    std::span<Device* const> do_devices() const override { return own_->devices(); }
    std::optional<std::span<const std::uint32_t>> do_owned() const override { return own_->owned(); }
    const Settings& do_settings() const override { return own_->settings(); }

    Ranks& ranks_;
    std::unique_ptr<Session> own_;
};

} // namespace tandem
