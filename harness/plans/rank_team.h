// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/distributed/agreement.h"
#include "backends/device.h"
#include "harness/plans/run_options.h"
#include "harness/plans/own_device.h"

#include <memory>

namespace tandem {

struct Cell;
class Session;

/// The ranks of a job that measure each cell together, with one device each. All run the same program: they
/// open the same scene, prepare the same sessions and run the same frames. Rank 0 makes decisions that depend
/// on clocks, and it checks, prints and records. Functions are collective: all ranks call them in the same
/// order.
class RankTeam {
public:
    /// `ranks` must outlive this.
    explicit RankTeam(Ranks& ranks) : ranks_(ranks), local_rank_(local_rank(ranks)) {}
    RankTeam(const RankTeam&) = delete;
    RankTeam& operator=(const RankTeam&) = delete;

    bool is_first() const { return ranks_.is_first(); }
    /// Runs `work` on all ranks. An error on one rank is thrown on all.
    void together(const std::function<void()>& work) { run_together(ranks_, work); }
    /// Returns the value of rank 0.
    template<class Value>
    Value decided(const Value& own) {
        return of_rank_0(ranks_, own);
    }

    /// The name of this rank's device in the list of the options. Throws InputError when the list makes
    /// several cells, or has more devices than a machine has ranks.
    std::string own_device(const RunOptions& options) const;
    /// The device of this rank for a name such as "cuda:each", which distributes the machine's devices.
    std::string own_of_each(const std::string& name, const std::vector<BackendReport>& backends) const;
    /// Exchanges the ranks' devices. Throws InputError when two ranks share a GPU.
    void open(const Device& own);
    /// Throws InputError unless all ranks have the same text: keys of cells and digests of scenes.
    void check_same(const std::string& own);
    /// The settings of the cell's session on this rank: the ranks of a machine divide its threads.
    Settings settings_of(const Cell& cell) const;
    /// Prepares a session on all ranks.
    std::unique_ptr<Session> prepare(const Cell& cell, const Scene& scene);
    /// Gathers one message from each rank, by rank.
    std::vector<Ranks::Bytes> gather(std::span<const std::byte> own) { return ranks_.gather_to_all(own); }
    /// The devices of all ranks, by rank.
    const std::vector<DeviceInfo>& devices() const { return devices_; }

private:
    Ranks& ranks_;
    LocalRank local_rank_;
    std::vector<DeviceInfo> devices_;
};

// The same functions for any cell; a cell that one process measures alone has no team.

inline bool is_first(const RankTeam* team) { return team == nullptr || team->is_first(); }

template<class Work>
void together(RankTeam* team, const Work& work) {
    if (team == nullptr) return work();
    team->together(work);
}

template<class Value>
Value decided(RankTeam* team, const Value& own) {
    return team == nullptr ? own : team->decided(own);
}

} // namespace tandem
