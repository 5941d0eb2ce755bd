// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/distributed/load_balancer.h"
#include "algorithms/distributed/partitioner.h"
#include "algorithms/parameters/parameter.h"

#include <functional>

namespace tandem {

/// The subdomains of the devices of a process or of the ranks of a job, and when they change: when they do
/// not cover a frame, or when one device takes much longer than the average. Ranks call the same functions
/// with the same values, so that all have the same partition.
class RepartitionLoop {
public:
    /// Candidate pairs by body over all subdomains; called only when the load is unbalanced.
    using CountPairs = std::function<std::vector<std::uint64_t>()>;

    /// `scene` must outlive this.
    RepartitionLoop(const Scene& scene, const Settings& settings, std::size_t subdomains);

    /// Whether the frame needs another partition before it runs: the last one does not cover it, or the load
    /// was unbalanced.
    bool is_due(const FrameInput& input) {
        return !partitioner_.is_valid(input) || balancer_.should_repartition();
    }
    /// Makes a new partition from a frame, or from balls that contain the bodies.
    template<class Positions>
    void repartition(const Positions& positions) {
        partitioner_.partition(positions, balancer_.speeds());
        balancer_.repartitioned();
    }
    /// Adds the times of a frame without retries and batches; `result.shared` has the work of every
    /// subdomain. Returns whether the load is unbalanced, and calibrates the next partition if it is.
    bool add_sample(const FrameResult& result, const CountPairs& count_pairs);

    const std::vector<Subdomain>& subdomains() const { return partitioner_.subdomains(); }
    const Partitioner& partitioner() const { return partitioner_; }
    /// Contacts of a candidate pair when the load was last unbalanced; 1 before.
    double contacts_a_pair() const { return contacts_a_pair_; }

private:
    Partitioner partitioner_;
    LoadBalancer balancer_;
    const bool has_pairs_; ///< answers have candidate pairs
    double contacts_a_pair_ = 1;
};

} // namespace tandem
