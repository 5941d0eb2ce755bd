// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/distributed/ghost_exchange.h"
#include "algorithms/distributed/device_vertex_exchange.h"
#include "algorithms/pipeline/resident_session.h"
#include "algorithms/distributed/repartition_loop.h"

namespace tandem {

/// The session of one rank of a job; each rank has its own device. Ranks own bodies and exchange ghosts, so
/// that exactly one rank finds each pair. All ranks call run() together. A rank reads only its own bodies
/// (owned()) and the fixed bodies of a frame. The result has the pairs of this rank, its `shared` the work of
/// each rank. The device stores bodies of the subdomain and candidates for ghosts only. An error on one rank
/// is thrown on all: DeviceError or OutOfMemory that names the rank.
class RankSession final : public Session {
public:
    /// Collective. The first partition uses frame 0, so that it is the same on all ranks. `fitted`:
    /// Traversal::fitted. All arguments passed by reference must outlive this.
    RankSession(const Traversal& traversal, Device& device, const Scene& scene, Settings fitted,
                Ranks& ranks);

    /// The bodies that the device stores now: own bodies, ghosts and candidates for ghosts, ascending.
    std::span<const std::uint32_t> stored_bodies() const {
        return local_scene_ ? std::span<const std::uint32_t>(local_scene_->numbers)
                            : std::span<const std::uint32_t>{};
    }

private:
    /// What ranks exchange at the end of a frame.
    struct Report {
        DeviceWork work;
        std::string failure;           ///< message of the error; empty: none
        bool is_out_of_memory = false; ///< the error is OutOfMemory
        bool is_representative = true; ///< the times are usable: no buffer had to grow
        bool needs_batches = false;    ///< vertices are needed in the host's memory
    };

    void do_reset() override;
    FrameResult do_run(const FrameInput& input, std::optional<std::span<const BodyPair>> body_pairs) override;
    FrameResult do_run_device_input(const DeviceFrameInput& frame,
                                    std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override;
    std::span<Device* const> do_devices() const override { return devices_; }
    std::optional<std::span<const std::uint32_t>> do_owned() const override { return own_bodies(); }
    const Settings& do_settings() const override { return session_ ? session_->settings() : settings_; }

    const std::vector<std::uint32_t>& own_bodies() const {
        return partition_.subdomains()[static_cast<std::size_t>(ranks_.rank())].own;
    }
    void update_device();
    void build_session_for(const std::vector<std::uint32_t>& needed);
    void build_session(const std::vector<std::uint32_t>& bodies);
    void discard_session();
    void exchange(const FrameInput& input, Report& own);
    static void record_failure(const std::exception& error, Report& own);
    FrameInput local_input() const { return {local_frame_, has_successors_ ? &local_next_ : nullptr}; }
    void copy_local_input(const FrameInput& input);
    void copy_local_frame(const Frame& frame, const Frame& ghost_frame, Frame& local_frame) const;
    void exchange_vertices(const FrameInput& input, GhostExchange::Traffic& traffic, Report& own);
    FrameResult run_local(Report& own);
    void run_subdomain(const FrameInput& input, FrameResult& result, Report& own);
    std::vector<Report> gather_reports(const Report& own);
    void throw_failure(const std::vector<Report>& all) const;
    Ranks::Bytes calibration_message(const Frame& frame, const FrameResult& result);
    std::vector<std::uint64_t> exchange_calibration(const Frame& frame, const FrameResult& result);
    void repartition_if_needed(const Frame& frame, FrameResult& result);

    const Traversal& traversal_;
    std::array<Device*, 1> devices_;
    const Scene& scene_;
    Settings settings_;
    Ranks& ranks_;
    RepartitionLoop partition_;
    GhostExchange ghosts_;
    DeviceVertexExchange device_exchange_;
    DisplacementTracker tracker_;
    std::vector<Ball> balls_;                  ///< by body, at the last partition
    std::shared_ptr<const Scene> local_scene_; ///< the bodies on the device; null without a session
    Frame local_frame_, local_next_;           ///< of local_scene_
    bool has_successors_;                      ///< the session has motion=linear, which uses local_next_
    Subdomain local_subdomain_;                ///< that of ghosts_, with indices in local_scene_
    std::unique_ptr<ResidentSession> session_; ///< null when this rank owns no bodies
    std::uint64_t expected_pairs_ = 0;         ///< of this rank after a repartition; 0: unknown
    bool counts_work_ = false;
};

} // namespace tandem
