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

/// Value of queue_bytes=device.
constexpr std::int64_t whole_array = 0;

constexpr Setting<QueueSizing> sizes_by{
    "sizes",
    QueueSizing::own,
    {{"own", QueueSizing::own}, {"release", QueueSizing::release}},
    "",
    "what derives sizes whose setting is 0; own: from work_items and local memory; release: the rule of the "
    "paper's release, which also gives group_size and batch"};
constexpr Setting<std::int64_t> groups{"groups", 0, ValueRange{0, 1 << 20}, "",
                                       "work-groups, each with a queue; 0: from work_items"};
constexpr Setting<std::int64_t> local_queue{"local_queue", 0, ValueRange{0, 1 << 20}, "LOCAL_QUEUE",
                                            "items of the local queue; 0: from the device's local memory"};
constexpr Setting<std::int64_t> initial_items{"initial_items", 0, ValueRange{0, 1 << 20}, "INITIAL_ITEMS",
                                              "items that a group loads from its queue; 0: 3 per work-item"};
constexpr auto queue_bytes =
    Setting<std::int64_t>{"queue_bytes", 67108864, ValueRange{12, std::int64_t{1} << 40}, "",
                          "bytes of all queues in one of the two arrays; device: by the rule of the paper's "
                          "release, a quarter of the device's memory or its largest allocation"}
        .with_word("device", whole_array);
constexpr Setting<std::int64_t> queue_capacity{"queue_capacity", 0, ValueRange{0, std::int64_t{1} << 31}, "",
                                               "items of one queue; 0: from queue_bytes"};
constexpr Setting<std::int64_t> idle_limit{"idle_limit", 0, ValueRange{0, 1 << 20}, "IDLE_LIMIT",
                                           "idle groups that end a launch; 0: 2/3 of the groups"};
constexpr Setting<std::int64_t> batch{"batch", 0, ValueRange{0, std::int64_t{1} << 31}, "",
                                      "body pairs per batch; 0: all, with sizes=release one per group"};
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

constexpr std::array<const Parameter*, 13> own{
    &sizes_by, &groups, &local_queue, &initial_items, &queue_bytes, &queue_capacity,    &idle_limit,
    &batch,    &upload, &refill,      &full_exit,     &balance,     &balance_group_size};

/// What the release that produced the paper's tables does: one root pair per group and batch, the whole array
/// uploaded, a full local queue ends the launch, and body pairs from boxes of spheres.
std::vector<Assignment> published(std::initializer_list<Assignment> sizes) {
    std::vector<Assignment> all{parameters::k(8),
                                parameters::origin(Origin::world),
                                parameters::residency(Residency::published),
                                parameters::copies(TreeCopies::pair),
                                parameters::broad(Broad::sphere_boxes),
                                upload(QueueUpload::queues),
                                refill(false),
                                full_exit(true),
                                balance(BalanceMethod::serial)};
    all.insert(all.end(), sizes);
    return all;
}

/// The same with the sizes that the release has on one of the paper's GPUs. As in the release, `idle` is 0.67
/// times the local size. `array`: a quarter of the GPU's memory.
std::vector<Assignment> published_on(int group_count, int local_size, int local_items, int idle,
                                     int balancing, std::int64_t array) {
    return published({groups(group_count), parameters::group_size(local_size), local_queue(local_items),
                      initial_items(std::min(3 * local_size, local_items)), idle_limit(idle),
                      batch(group_count), balance_group_size(balancing), queue_bytes(array)});
}

const std::vector<Preset> presets{
    {"fair",
     "all body pairs at once, found on the device, refill inside a launch, parallel balance",
     {parameters::broad(Broad::device), parameters::builder(Builder::sah)},
     "gProximity"},
    {"published",
     "the paper's release as it would run on this device, its queue array included",
     published({sizes_by(QueueSizing::release), queue_bytes(whole_array), balance_group_size(1024)}),
     "gProximity published",
     {},
     true},
    {"published-c2075",
     "the same with the sizes it has on a C2075",
     published_on(28, 1024, 2047, 686, 1024, 1409138688),
     "gProximity published-c2075",
     {},
     true},
    {"published-k20c",
     "the same with the sizes it has on a K20c",
     published_on(26, 992, 1023, 664, 1024, 1258176512),
     "gProximity published-k20c",
     {},
     true},
    {"published-k40c",
     "the same with the sizes it has on a K40c",
     published_on(30, 992, 1023, 664, 1024, 3019898880),
     "gProximity published-k40c",
     {},
     true},
    {"published-w8100",
     "the same with the sizes it has on a FirePro W8100",
     published_on(320, 256, 682, 171, 256, 2147483648),
     "gProximity published-w8100",
     {},
     true},
    {"unc2010",
     "the original's numbers: 128 x 64 work-items, queues of 50,000",
     {groups(128), parameters::group_size(64), local_queue(600), initial_items(192), queue_capacity(50000),
      idle_limit(86), batch(128), refill(false), full_exit(true), balance(BalanceMethod::serial),
      balance_group_size(512)},
     "gProximity unc2010",
     {},
     true},
};

std::uint32_t number(const Settings& settings, const Setting<std::int64_t>& setting) {
    return static_cast<std::uint32_t>(settings[setting]);
}

/// Bytes of one of the two arrays.
std::uint64_t array_bytes(const Settings& settings, const DeviceInfo& info) {
    const auto given = settings[queue_bytes];
    return given == whole_array ? released_array_bytes(info) : static_cast<std::uint64_t>(given);
}

/// Items of one queue when the array is divided evenly.
std::uint32_t capacity_from_bytes(const Settings& settings, std::uint64_t bytes, std::uint32_t queues) {
    const auto items = bytes / (item_bytes * queues);
    if (items > MOST_QUEUE_ITEMS)
        throw InputError(fmt::format("setting queue_bytes={} makes {} queues of {} items and {} is the most; "
                                     "lower it, or raise groups",
                                     settings.text("queue_bytes"), queues, items, MOST_QUEUE_ITEMS));
    return static_cast<std::uint32_t>(items);
}

/// Items of a local queue by the release's rule: four groups share a compute unit's local memory, of which
/// the kernel itself takes one item.
std::uint32_t released_local_items(const DeviceInfo& info) {
    return static_cast<std::uint32_t>(
        std::min<std::uint64_t>((info.local_bytes - item_bytes) / (4 * item_bytes), 1 << 20));
}

/// Work-items of a group by the release's rule. A device that runs groups of one work-item gets the other
/// sizes of a GPU's groups.
std::uint32_t released_local_size(const DeviceInfo& info) {
    constexpr std::uint32_t most = 1024, multiple = 32;
    const auto allowed = info.max_group_size == 1 ? most : std::min(info.max_group_size, most);
    const auto size = std::min(allowed, released_local_items(info));
    return size < multiple ? size : size / multiple * multiple;
}

/// Unless set, a quarter of the local memory, so that several groups share a compute unit.
std::uint32_t local_items(const Settings& settings, const DeviceInfo& info) {
    const auto fitting =
        settings[sizes_by] == QueueSizing::release
            ? released_local_items(info)
            : static_cast<std::uint32_t>(std::min<std::uint64_t>(info.local_bytes / item_bytes / 4, 2048));
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

void fit_group_size(Settings& settings, const DeviceInfo& info) {
    if (settings[sizes_by] == QueueSizing::release && settings[parameters::group_size] == 0)
        settings.set(parameters::group_size(released_local_size(info)));
}

std::uint64_t released_array_bytes(const DeviceInfo& info) {
    return std::min(info.max_allocation, info.global_bytes / 4);
}

bool takes_whole_array(const Settings& settings) {
    return settings[queue_bytes] == whole_array && settings[queue_capacity] == 0;
}

/// Sizes whose settings are 0, as the release has them.
QueueSizes released_sizes(const Settings& settings, const DeviceInfo& info) {
    constexpr std::uint32_t work_items_per_unit = 2048;
    const auto given = number(settings, parameters::group_size);
    const auto local_size = info.max_group_size == 1 ? released_local_size(info) : given;
    QueueSizes sizes;
    sizes.groups = std::max(1u, work_items_per_unit * info.compute_units / local_size);
    sizes.initial_items = std::min(3 * local_size, local_items(settings, info));
    sizes.idle_limit = local_size * 67 / 100;
    sizes.batch = sizes.groups;
    return sizes;
}

QueueSizes own_sizes(const Settings& settings, const DeviceInfo& info) {
    const auto group_size = number(settings, parameters::group_size);
    // Groups of one work-item are enough for any number of cores, and a balance visits the queue of each.
    const auto units = info.max_group_size == 1 ? 1 : info.compute_units;
    QueueSizes sizes;
    sizes.groups = number(settings, parameters::work_items) * units / group_size;
    sizes.initial_items = 3 * group_size;
    return sizes;
}

/// With full_exit a launch ends as soon as a queue has no room for this many more items (settle_round of
/// gproximity.cl), so that in smaller queues every launch would end after one round. Throws InputError.
void check_margin(const Settings& settings, const QueueSizes& sizes, const DeviceInfo& info) {
    const std::uint64_t group_size = info.max_group_size == 1 ? 1 : number(settings, parameters::group_size);
    const auto margin = 2 * group_size + sizes.local_queue;
    if (sizes.queue_capacity > margin) return;
    throw InputError(
        fmt::format("setting queue_bytes={} makes {} queues of {} items on {}, but with full_exit=yes a "
                    "launch ends where "
                    "{} items are free; give at least --set queue_bytes={}, or set queue_capacity",
                    settings.text("queue_bytes"), sizes.groups, sizes.queue_capacity, info.id, margin,
                    (margin + 1) * item_bytes * sizes.groups));
}

QueueSizes queue_sizes(const Settings& settings, const DeviceInfo& info) {
    const bool as_release = settings[sizes_by] == QueueSizing::release;
    auto sizes = as_release ? released_sizes(settings, info) : own_sizes(settings, info);
    const auto set_from = [&](std::uint32_t& size, const Setting<std::int64_t>& setting,
                              std::uint32_t least) {
        if (const auto given = number(settings, setting); given != 0) size = given;
        size = std::max(size, least);
    };
    set_from(sizes.groups, groups, 1);
    set_from(sizes.initial_items, initial_items, 1);
    set_from(sizes.batch, batch, 0);
    if (!as_release) sizes.idle_limit = sizes.groups * 2 / 3;
    set_from(sizes.idle_limit, idle_limit, 1);
    sizes.local_queue = local_items(settings, info);
    sizes.queue_capacity = number(settings, queue_capacity);
    const bool is_derived = sizes.queue_capacity == 0;
    if (is_derived)
        sizes.queue_capacity = capacity_from_bytes(settings, array_bytes(settings, info), sizes.groups);
    sizes.queue_capacity = std::max(sizes.queue_capacity, 2u);
    sizes.balance_group_size = std::min(number(settings, balance_group_size), info.max_group_size);
    sizes.refill = settings[refill];
    sizes.full_exit = settings[full_exit];
    sizes.upload = settings[upload];
    sizes.balance = settings[balance];
    if (is_derived && sizes.full_exit) check_margin(settings, sizes, info);
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
