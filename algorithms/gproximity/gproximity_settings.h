// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/table.h"
#include "backends/device.h"

#include <span>

namespace tandem {

/// The settings that only this algorithm has, and its presets.
std::span<const Parameter* const> gproximity_parameters();
std::span<const Preset> gproximity_presets();

/// What travels to the queues at the start of a batch.
enum class QueueUpload { seeds, queues };
/// Who balances the queues.
enum class Balance { parallel, serial };

/// The numbers of a gproximity session, once the device has filled in what was left to it.
struct QueueSizes {
    std::uint32_t groups = 0;         ///< work-groups = queues
    std::uint32_t local_queue = 0;    ///< items
    std::uint32_t initial_items = 0;  ///< loaded at the start and at each refill
    std::uint32_t queue_capacity = 0; ///< items of one queue in global memory
    std::uint32_t idle_limit = 0;     ///< idle groups that end a launch; 0: never
    std::uint32_t batch = 0;          ///< body pairs a batch; 0: all
    std::uint32_t balance_group_size = 0;
    bool refill = true;     ///< load more from the own queue inside a launch
    bool full_exit = false; ///< end a group's launch when its local queue is full
    QueueUpload upload = QueueUpload::seeds;
    Balance balance = Balance::parallel;
};

/// `settings` are fitted ones. Throws InputError when the local queue does not fit the device or a queue
/// would hold more than MOST_QUEUE_ITEMS.
QueueSizes queue_sizes(const Settings& settings, const DeviceInfo& info);

/// What kernels are compiled with beside a hierarchy's and a walk's own defines.
void add_defines(const QueueSizes& sizes, Defines& defines);

} // namespace tandem
