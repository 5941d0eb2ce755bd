// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/distributed/ghost_exchange.h"
#include "algorithms/distributed/device_vertex_exchange.h"
#include "algorithms/resident_session.h"
#include "algorithms/distributed/load_balancer.h"

namespace tandem {

/// A session of one rank of a job, each with a device of its own: ranks own bodies, tell each other where
/// those are that come near, and each pair is found by one of them. All ranks call run() together. Of a frame
/// a rank needs its own bodies (owned()) and the fixed ones; what it says of others is not looked at. The
/// result is what this rank has found, its `shared` what each of them has done. On the device are only bodies
/// that have a part in this rank's share. An error on one rank is one of all: DeviceError that names it.
class RankSession final : public Session {
public:
    /// Bodies are dealt by where frame 0 has them, so that all ranks know who owns them. `fitted`:
    /// Traversal::fitted. All must outlive this.
    RankSession(const Traversal& traversal, Device& device, const Scene& scene, Settings fitted,
                Ranks& ranks);

private:
    /// What a rank tells all others at the end of a frame.
    struct Report {
        DeviceWork work;
        std::string failure;
        bool is_memory = false;     ///< that there is too little
        bool is_usual = true;       ///< the frame took what frames take: no buffer had to grow
        bool is_in_batches = false; ///< it needs vertices in the host's memory
    };

    void do_reset() override;
    FrameResult do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) override;
    FrameResult do_run_device_input(const DeviceFrame& frame,
                                    std::optional<std::span<const BodyPair>> body_pairs) override;
    void do_count_work(bool on) override;
    std::span<Device* const> do_devices() const override { return devices_; }
    std::optional<std::span<const std::uint32_t>> do_owned() const override { return own_bodies(); }
    const Settings& do_settings() const override { return session_ ? session_->settings() : settings_; }

    const std::vector<std::uint32_t>& own_bodies() const {
        return partitioner_.subdomains()[static_cast<std::size_t>(ranks_.rank())].own;
    }
    void apply_subdomain();
    void build_for(const std::vector<std::uint32_t>& needed);
    void build(const std::vector<std::uint32_t>& bodies);
    void drop();
    void exchange(const Frame& frame, Report& own);
    static void note(const std::exception& error, Report& own);
    void take_frame(const Frame& frame);
    void pass_vertices(const Frame& frame, GhostExchange::Traffic& traffic, Report& own);
    FrameResult run_local(Report& own);
    void walk(const Frame& frame, FrameResult& result, Report& own);
    std::vector<Report> reports(const Report& own);
    void fail(const std::vector<Report>& all) const;
    Ranks::Bytes calibration_message(const Frame& frame, const FrameResult& result);
    void repartition(const Frame& frame, FrameResult& result);

    const Traversal& traversal_;
    std::array<Device*, 1> devices_;
    const Scene& scene_;
    Settings settings_;
    Ranks& ranks_;
    Partitioner partitioner_;
    LoadBalancer balancer_;
    GhostExchange ghosts_;
    DeviceVertexExchange device_exchange_;
    DisplacementTracker places_;
    std::vector<Ball> balls_;                  ///< by body, when they were dealt
    std::shared_ptr<const Scene> local_scene_; ///< what is on the device; null without a session
    Frame local_frame_;                        ///< of local_scene_
    Subdomain local_subdomain_;                ///< the halo's share, by places in local_scene_
    std::unique_ptr<ResidentSession> session_; ///< none where the share has no bodies
    std::uint64_t expected_pairs_ = 0;         ///< of this rank's share after a new deal; 0: nobody knows
    double contacts_a_pair_ = 1;               ///< when it was dealt
    bool counts_work_ = false;
};

} // namespace tandem
