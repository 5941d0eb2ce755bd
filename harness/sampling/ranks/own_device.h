// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"
#include "backends/ranks.h"

#include <string>

namespace tandem {

/// A rank among those of its machine.
struct LocalRank {
    std::size_t before = 0; ///< ranks of lower numbers
    std::size_t count = 0;  ///< ranks, this one included
};

/// By all ranks together.
LocalRank local_rank(Ranks& ranks);

/// Which of the devices "cuda:0+cuda:1" is the rank's, by the names that it has there: a launcher may show
/// every rank another GPU as cuda:0. Throws InputError where there are more devices than ranks.
std::string device_of_rank(const std::string& names, const LocalRank& place);

/// By all ranks together: the sentence against one GPU for two ranks of a machine, whose times would say
/// nothing; empty where each has its own. Processors can be shared.
std::string shared_gpu(Ranks& ranks, const DeviceInfo& own);

/// By all ranks together: what each has.
std::vector<DeviceInfo> devices_of_ranks(Ranks& ranks, const DeviceInfo& own);

} // namespace tandem
