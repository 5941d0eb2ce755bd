// SPDX-License-Identifier: MIT
#include "algorithms/gproximity/gproximity_settings.h"

#include "algorithms/gproximity/queues.clh"
#include "scenes/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::uint64_t item_bytes = 12;

const std::vector<Parameter> parameters{
    {"groups", "0", {}, 0, 1 << 20, "work-groups, each with a queue; 0: from work_items"},
    {"local_queue", "0", {}, 0, 1 << 20, "items of the local queue; 0: from the device's local memory"},
    {"initial_items", "0", {}, 0, 1 << 20, "items loaded from the own queue; 0: 3 a work-item"},
    {"queue_bytes", "67108864", {}, 12, std::int64_t{1} << 40, "all queues together; one of the two arrays"},
    {"queue_capacity", "0", {}, 0, std::int64_t{1} << 31, "items of one queue; 0: from queue_bytes"},
    {"idle_limit", "0", {}, 0, 1 << 20, "idle groups that end a launch; 0: 2/3 of the groups"},
    {"batch", "0", {}, 0, std::int64_t{1} << 31, "body pairs a batch; 0: all"},
    {"upload", "seeds", {"seeds", "queues"}, 0, 0, "queues: the whole array in every batch, as published"},
    {"refill", "yes", {"yes", "no"}, 0, 0, "load more from the own queue inside a launch"},
    {"full_exit", "no", {"yes", "no"}, 0, 0, "end a group's launch when its local queue is full"},
    {"balance",
     "parallel",
     {"parallel", "serial"},
     0,
     0,
     "parallel: one item a work-item; serial: one group, queue by queue"},
    {"balance_group_size", "256", {}, 1, 1024, "work-items of the balancing group"},
};

/// A preset of the release that made the paper's tables (tvcg18.md 2.1): one root pair per group and batch,
/// the whole array uploaded, a full local queue ends the launch. `idle_limit` 0.67 times the local size, as
/// it was.
Settings published(int groups, int local_size, int local_queue, int idle_limit, int balance) {
    return {{"k", "8"},
            {"residency", "published"},
            {"groups", std::to_string(groups)},
            {"group_size", std::to_string(local_size)},
            {"local_queue", std::to_string(local_queue)},
            {"initial_items", std::to_string(std::min(3 * local_size, local_queue))},
            {"idle_limit", std::to_string(idle_limit)},
            {"batch", std::to_string(groups)},
            {"upload", "queues"},
            {"refill", "no"},
            {"full_exit", "yes"},
            {"balance", "serial"},
            {"balance_group_size", std::to_string(balance)}};
}

const std::vector<Preset> presets{
    {"fair",
     "all body pairs at once, found on the device, refill inside a launch, parallel balance",
     {{"broad", "device"}}},
    {"published", "the paper's release with the geometry it had on a K40c",
     published(30, 992, 1023, 664, 1024)},
    {"published-c2075", "the same on a C2075", published(28, 1024, 2047, 686, 1024)},
    {"published-k20c", "the same on a K20c", published(26, 992, 1023, 664, 1024)},
    {"published-k40c", "the same on a K40c", published(30, 992, 1023, 664, 1024)},
    {"published-w8100", "the same on a FirePro W8100", published(320, 256, 682, 171, 256)},
    {"unc2010",
     "the original's numbers: 128 x 64 work-items, queues of 50,000",
     {{"groups", "128"},
      {"group_size", "64"},
      {"local_queue", "600"},
      {"initial_items", "192"},
      {"queue_capacity", "50000"},
      {"idle_limit", "86"},
      {"batch", "128"},
      {"refill", "no"},
      {"full_exit", "yes"},
      {"balance", "serial"},
      {"balance_group_size", "512"}}},
};

std::uint32_t number(const Settings& settings, const std::string& name) {
    return static_cast<std::uint32_t>(integer(settings, name));
}

} // namespace

std::span<const Parameter> gproximity_parameters() { return parameters; }
std::span<const Preset> gproximity_presets() { return presets; }

QueueSizes queue_sizes(const Settings& settings, const DeviceInfo& info, std::uint32_t group_size) {
    QueueSizes sizes;
    sizes.groups = number(settings, "groups");
    if (sizes.groups == 0)
        sizes.groups = std::max(1u, number(settings, "work_items") * info.compute_units / group_size);
    sizes.local_queue = number(settings, "local_queue");
    // A quarter of the local memory, so that several groups share a compute unit.
    const auto fitting =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(info.local_bytes / item_bytes / 4, 2048));
    if (sizes.local_queue == 0) sizes.local_queue = std::max(fitting, 4u);
    if (sizes.local_queue * item_bytes + 64 > info.local_bytes)
        throw InputError(
            fmt::format("setting local_queue={} needs {} bytes of local memory and {} has {}; lower it",
                        sizes.local_queue, sizes.local_queue * item_bytes, info.id, info.local_bytes));
    sizes.initial_items = number(settings, "initial_items");
    if (sizes.initial_items == 0) sizes.initial_items = 3 * group_size;
    sizes.queue_capacity = number(settings, "queue_capacity");
    if (sizes.queue_capacity == 0) {
        const auto items =
            static_cast<std::uint64_t>(integer(settings, "queue_bytes")) / (item_bytes * sizes.groups);
        if (items > MOST_QUEUE_ITEMS)
            throw InputError(
                fmt::format("setting queue_bytes={} makes {} queues of {} items and {} is the most; "
                            "lower it, or raise groups",
                            settings.at("queue_bytes"), sizes.groups, items, MOST_QUEUE_ITEMS));
        sizes.queue_capacity = static_cast<std::uint32_t>(items);
    }
    sizes.queue_capacity = std::max(sizes.queue_capacity, 2u);
    sizes.idle_limit = number(settings, "idle_limit");
    if (sizes.idle_limit == 0) sizes.idle_limit = std::max(1u, sizes.groups * 2 / 3);
    sizes.batch = number(settings, "batch");
    sizes.balance_group_size = std::min(number(settings, "balance_group_size"), info.max_group_size);
    return sizes;
}

} // namespace tandem
