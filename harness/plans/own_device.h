// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"
#include "backends/ranks.h"

#include <string>

namespace tandem {

/// The position of a rank among the ranks of its machine.
struct LocalRank {
    std::size_t before = 0; ///< number of local ranks with lower numbers
    std::size_t count = 0;  ///< number of local ranks, this one included
};

/// Collective: all ranks call it.
LocalRank local_rank(Ranks& ranks);

/// The device of this rank in a list such as "cuda:0+cuda:1". Names are local to the rank, because a launcher
/// may show each rank a different GPU as cuda:0. Throws InputError for more devices than local ranks.
std::string device_of_rank(const std::string& names, const LocalRank& local);

/// Collective. The error message when two ranks of a machine share a GPU, which makes their times
/// meaningless; empty otherwise. Ranks may share processors.
std::string shared_gpu(Ranks& ranks, const DeviceInfo& own);

/// Collective: the device of each rank, by rank.
std::vector<DeviceInfo> devices_of_ranks(Ranks& ranks, const DeviceInfo& own);

} // namespace tandem
