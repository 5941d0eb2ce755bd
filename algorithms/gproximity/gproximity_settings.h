// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/table.h"
#include "backends/device.h"

#include <span>

namespace tandem {

/// Settings that only this algorithm has, and its presets.
std::span<const Parameter* const> gproximity_parameters();
std::span<const Preset> gproximity_presets();

/// What derives sizes that are not given.
enum class QueueSizing { own, release };
/// Data that is uploaded to the queues at the start of a batch.
enum class QueueUpload { seeds, queues };
/// How the queues are balanced.
enum class BalanceMethod { parallel, serial };

/// Sizes of a gproximity session. The device determines those whose setting is 0.
struct QueueSizes {
    std::uint32_t groups = 0;         ///< work-groups, with one queue each
    std::uint32_t local_queue = 0;    ///< items of a local queue
    std::uint32_t initial_items = 0;  ///< items loaded at the start and at each refill
    std::uint32_t queue_capacity = 0; ///< items of one queue in global memory
    std::uint32_t idle_limit = 0;     ///< idle groups that end a launch; 0: never
    std::uint32_t batch = 0;          ///< body pairs per batch; 0: all
    std::uint32_t balance_group_size = 0;
    bool refill = true;     ///< load more items from the own queue inside a launch
    bool full_exit = false; ///< end a group's launch when its local queue is full
    QueueUpload upload = QueueUpload::seeds;
    BalanceMethod balance = BalanceMethod::parallel;
};

/// Sets the group size that sizes=release derives from the device, unless one is given.
void fit_group_size(Settings& settings, const DeviceInfo& info);

/// Bytes of one array of queues in the paper's release: the largest allocation or a quarter of the memory.
std::uint64_t released_array_bytes(const DeviceInfo& info);

/// Whether the queues have the size of the release's array (queue_bytes=device).
bool takes_whole_array(const Settings& settings);

/// `settings` must be fitted. Throws InputError when the local queue does not fit the device or a queue would
/// have more than MOST_QUEUE_ITEMS.
QueueSizes queue_sizes(const Settings& settings, const DeviceInfo& info);

/// Adds the defines of kernels beyond those of a hierarchy and a walk.
void add_defines(const QueueSizes& sizes, Defines& defines);

} // namespace tandem
