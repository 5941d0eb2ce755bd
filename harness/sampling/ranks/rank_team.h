// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/distributed/agreement.h"
#include "backends/device.h"
#include "harness/commands/commands.h"
#include "harness/sampling/ranks/own_device.h"

#include <memory>

namespace tandem {

struct Cell;
class Session;

/// The ranks of a job that measure together, each with one device. All run the same program: they open the
/// same scene, prepare the same sessions and run the same frames. Rank 0 decides what depends on clocks,
/// checks, prints and records. All ranks call the functions together, in the same order.
class RankTeam {
public:
    /// `ranks` must outlive this.
    explicit RankTeam(Ranks& ranks) : ranks_(ranks), place_(local_rank(ranks)) {}
    RankTeam(const RankTeam&) = delete;
    RankTeam& operator=(const RankTeam&) = delete;

    bool is_first() const { return ranks_.is_first(); }
    /// An error of one rank becomes one of all.
    void together(const std::function<void()>& work) { run_together(ranks_, work); }
    /// What rank 0 has.
    template<class Value>
    Value decided(const Value& own) {
        return of_rank_0(ranks_, own);
    }

    /// The name of this rank's device, of those that the options name for all. Throws InputError where they
    /// name several cells, or more devices than a machine has ranks.
    std::string own_device(const RunOptions& options) const;
    /// "cuda:each": of the devices of this machine, the one for this rank.
    std::string own_of_each(const std::string& name, const std::vector<BackendReport>& backends) const;
    /// Exchanges what each rank's device is. Throws InputError where two ranks have one GPU.
    void open(const Device& own);
    /// Throws InputError unless all ranks have the same: keys of cells, digests of scenes.
    void check_same(const std::string& own);
    /// A session of all ranks.
    std::unique_ptr<Session> prepare(const Cell& cell, const Scene& scene);
    /// Messages, one from each rank, by rank.
    std::vector<Ranks::Bytes> gather(std::span<const std::byte> own) { return ranks_.gather_to_all(own); }
    /// Those of all ranks, by rank.
    const std::vector<DeviceInfo>& devices() const { return devices_; }

private:
    Ranks& ranks_;
    LocalRank place_;
    std::vector<DeviceInfo> devices_;
};

// The same for cells that one process measures alone, which have no team.

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

/// A session of a cell: of this process alone, or of all ranks.
std::unique_ptr<Session> prepare_session(const Cell& cell, const Scene& scene);
/// What a cell runs on: its devices, or those of all ranks.
std::vector<DeviceInfo> infos_of(const Cell& cell);

} // namespace tandem
