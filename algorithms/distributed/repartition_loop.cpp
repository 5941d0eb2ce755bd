// SPDX-License-Identifier: MIT
#include "algorithms/distributed/repartition_loop.h"

#include "algorithms/parameters/table.h"

namespace tandem {

RepartitionLoop::RepartitionLoop(const Scene& scene, const Settings& settings, std::size_t subdomains)
    : partitioner_(scene, geometry_of(settings), subdomains),
      balancer_(subdomains),
      has_pairs_(has_pairs(settings[parameters::output])) {}

bool RepartitionLoop::add_sample(const FrameResult& result, const CountPairs& count_pairs) {
    std::vector<double> work;
    for (std::size_t i = 0; i < result.shared.size(); ++i)
        work.push_back(partitioner_.work_of(i, result.shared[i].pairs));
    balancer_.add_sample(result.shared, work);
    if (!balancer_.should_repartition()) return false;
    const auto counts = count_pairs(); // in any case, because the ranks of a job exchange more than counts
    if (has_pairs_) {
        contacts_a_pair_ = result.contacts_a_pair();
        partitioner_.calibrate(counts);
    }
    return true;
}

} // namespace tandem
