// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "backends/ranks.h"

namespace tandem {

/// A session of all ranks of a job, made of the session that each of them has (RankSession). All ranks call
/// its functions together, and those of its results. Counts and digests of a result are those of all ranks,
/// on every rank; pairs and contacts come to rank 0 when they are downloaded, and to no other.
class JobSession final : public Session {
public:
    /// `ranks` must outlive this and its results.
    JobSession(Ranks& ranks, std::unique_ptr<Session> own) : ranks_(ranks), own_(std::move(own)) {}

private:
    void do_reset() override { own_->reset(); }
    FrameResult do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override { own_->count_work(on); }
    std::span<Device* const> do_devices() const override { return own_->devices(); }
    std::optional<std::span<const std::uint32_t>> do_owned() const override { return own_->owned(); }
    const Settings& do_settings() const override { return own_->settings(); }

    Ranks& ranks_;
    std::unique_ptr<Session> own_;
};

} // namespace tandem
