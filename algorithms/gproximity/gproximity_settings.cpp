// SPDX-License-Identifier: MIT
#include "algorithms/gproximity/gproximity_settings.h"

#include "algorithms/gproximity/queues.clh"
#include "base/error.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace tandem {

namespace {

/// A body pair and two nodes.
constexpr std::uint64_t item_bytes = 12;

constexpr Setting<std::int64_t> groups{"groups", 0, ValueRange{0, 1 << 20}, "",
                                       "work-groups, each with a queue; 0: from work_items"};
constexpr Setting<std::int64_t> local_queue{"local_queue", 0, ValueRange{0, 1 << 20}, "LOCAL_QUEUE",
                                            "items of the local queue; 0: from the device's local memory"};
constexpr Setting<std::int64_t> initial_items{"initial_items", 0, ValueRange{0, 1 << 20}, "INITIAL_ITEMS",
                                              "items that a group loads from its queue; 0: 3 per work-item"};
constexpr Setting<std::int64_t> queue_bytes{"queue_bytes", 67108864, ValueRange{12, std::int64_t{1} << 40},
                                            "", "bytes of all queues in one of the two arrays"};
constexpr Setting<std::int64_t> queue_capacity{"queue_capacity", 0, ValueRange{0, std::int64_t{1} << 31}, "",
                                               "items of one queue; 0: from queue_bytes"};
constexpr Setting<std::int64_t> idle_limit{"idle_limit", 0, ValueRange{0, 1 << 20}, "IDLE_LIMIT",
                                           "idle groups that end a launch; 0: 2/3 of the groups"};
constexpr Setting<std::int64_t> batch{"batch", 0, ValueRange{0, std::int64_t{1} << 31}, "",
                                      "body pairs per batch; 0: all"};
constexpr Setting<QueueUpload> upload{"upload",
                                      QueueUpload::seeds,
                                      {{"seeds", QueueUpload::seeds}, {"queues", QueueUpload::queues}},
                                      "",
                                      "queues: upload the whole array in every batch, as published"};
constexpr Setting<bool> refill{"refill",
                               true,
                               {{"yes", true}, {"no", false}},
                               "REFILL",
                               "load more items from the group's queue inside a launch"};
constexpr Setting<bool> full_exit{"full_exit",
                                  false,
                                  {{"yes", true}, {"no", false}},
                                  "FULL_EXIT",
                                  "end a group's launch when its local queue is full"};
constexpr Setting<BalanceMethod> balance{
    "balance",
    BalanceMethod::parallel,
    {{"parallel", BalanceMethod::parallel}, {"serial", BalanceMethod::serial}},
    "",
    "parallel: one item per work-item; serial: one group, queue by queue"};
constexpr Setting<std::int64_t> balance_group_size{"balance_group_size", 256, ValueRange{1, 1024}, "",
                                                   "work-items of the balancing group"};

constexpr std::array<const Parameter*, 12> own{
    &groups, &local_queue, &initial_items, &queue_bytes, &queue_capacity, &idle_limit,
    &batch,  &upload,      &refill,        &full_exit,   &balance,        &balance_group_size};

/// A preset of the release that produced the paper's tables: one root pair per group and batch, the whole
/// array uploaded, and a full local queue ends the launch. As in the release, `idle` is 0.67 times the local
/// size.
std::vector<Assignment> published(int group_count, int local_size, int local_items, int idle, int balancing) {
    return {parameters::k(8),
            parameters::residency(Residency::published),
            groups(group_count),
            parameters::group_size(local_size),
            local_queue(local_items),
            initial_items(std::min(3 * local_size, local_items)),
            idle_limit(idle),
            batch(group_count),
            upload(QueueUpload::queues),
            refill(false),
            full_exit(true),
            balance(BalanceMethod::serial),
            balance_group_size(balancing)};
}

const std::vector<Preset> presets{
    {"fair",
     "all body pairs at once, found on the device, refill inside a launch, parallel balance",
     {parameters::broad(Broad::device)}},
    {"published", "the paper's release with its launch geometry on a K40c",
     published(30, 992, 1023, 664, 1024)},
    {"published-c2075", "the same on a C2075", published(28, 1024, 2047, 686, 1024)},
    {"published-k20c", "the same on a K20c", published(26, 992, 1023, 664, 1024)},
    {"published-k40c", "the same on a K40c", published(30, 992, 1023, 664, 1024)},
    {"published-w8100", "the same on a FirePro W8100", published(320, 256, 682, 171, 256)},
    {"unc2010",
     "the original's numbers: 128 x 64 work-items, queues of 50,000",
     {groups(128), parameters::group_size(64), local_queue(600), initial_items(192), queue_capacity(50000),
      idle_limit(86), batch(128), refill(false), full_exit(true), balance(BalanceMethod::serial),
      balance_group_size(512)}},
};

std::uint32_t number(const Settings& settings, const Setting<std::int64_t>& setting) {
    return static_cast<std::uint32_t>(settings[setting]);
}

/// Items of one queue when queue_bytes are divided evenly.
std::uint32_t capacity_from_bytes(const Settings& settings, std::uint32_t queues) {
    const auto items = static_cast<std::uint64_t>(settings[queue_bytes]) / (item_bytes * queues);
    if (items > MOST_QUEUE_ITEMS)
        throw InputError(fmt::format("setting queue_bytes={} makes {} queues of {} items and {} is the most; "
                                     "lower it, or raise groups",
                                     settings[queue_bytes], queues, items, MOST_QUEUE_ITEMS));
    return static_cast<std::uint32_t>(items);
}

/// Unless set, a quarter of the local memory, so that several groups share a compute unit.
std::uint32_t local_items(const Settings& settings, const DeviceInfo& info) {
    const auto fitting =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(info.local_bytes / item_bytes / 4, 2048));
    const auto given = number(settings, local_queue);
    const auto items = given == 0 ? std::max(fitting, 4u) : given;
    if (items * item_bytes + 64 > info.local_bytes)
        throw InputError(
            fmt::format("setting local_queue={} needs {} bytes of local memory and {} has {}; lower it",
                        items, items * item_bytes, info.id, info.local_bytes));
    return items;
}

} // namespace

std::span<const Parameter* const> gproximity_parameters() { return own; }
std::span<const Preset> gproximity_presets() { return presets; }

QueueSizes queue_sizes(const Settings& settings, const DeviceInfo& info) {
    const auto group_size = number(settings, parameters::group_size);
    const auto or_else = [](std::uint32_t given, std::uint32_t otherwise) {
        return given != 0 ? given : std::max(1u, otherwise);
    };
    QueueSizes sizes;
    sizes.groups = or_else(number(settings, groups),
                           number(settings, parameters::work_items) * info.compute_units / group_size);
    sizes.local_queue = local_items(settings, info);
    sizes.initial_items = or_else(number(settings, initial_items), 3 * group_size);
    sizes.queue_capacity = number(settings, queue_capacity);
    if (sizes.queue_capacity == 0) sizes.queue_capacity = capacity_from_bytes(settings, sizes.groups);
    sizes.queue_capacity = std::max(sizes.queue_capacity, 2u);
    sizes.idle_limit = or_else(number(settings, idle_limit), sizes.groups * 2 / 3);
    sizes.batch = number(settings, batch);
    sizes.balance_group_size = std::min(number(settings, balance_group_size), info.max_group_size);
    sizes.refill = settings[refill];
    sizes.full_exit = settings[full_exit];
    sizes.upload = settings[upload];
    sizes.balance = settings[balance];
    return sizes;
}

void add_defines(const QueueSizes& sizes, Defines& defines) {
    define(defines, local_queue, sizes.local_queue);
    define(defines, initial_items, sizes.initial_items);
    define(defines, idle_limit, sizes.idle_limit);
    define(defines, refill, sizes.refill);
    define(defines, full_exit, sizes.full_exit);
}

} // namespace tandem
