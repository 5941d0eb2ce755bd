// SPDX-License-Identifier: MIT
#include "algorithms/gproximity/queue_walker.h"

#include "algorithms/gproximity/queues.clh"
#include "algorithms/kernels/sources.h"
#include "base/error.h"
#include "base/memory.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::uint64_t item_words = ITEM_WORDS;
constexpr std::uint64_t least_capacity = 2; ///< minimum for a queue; one of its items stays free
constexpr auto too_many_items =
    "gproximity: its queues have 2^31 node pairs or more, which it cannot count; set batch, or use chunked";

constexpr Counter balances{"balances", "launches", "balance launches that moved work"};
constexpr Counter refills{"refills", "loads", "times a group loaded more from its own queue inside a launch"};
constexpr Counter spills{"spills", "node pairs",
                         "node pairs that left a full local queue for the global one"};
constexpr Counter own_bytes{"queue_bytes", "bytes", "one of the two arrays of queues", Counter::Total::last};
constexpr Counter published_bytes{"published_queue_bytes", "bytes",
                                  "bytes that the paper's release would allocate for it on this device",
                                  Counter::Total::last};

constexpr std::array all_counters{counters::bvtt_nodes, counters::seeds, balances, refills, spills, own_bytes,
                                  published_bytes};

/// The release allocates three buffers of this size: two arrays of queues and one of pairs. Those of a
/// processor are in the host's memory, whose free part is known before.
void refuse_large_array(const BuildContext& context) {
    const auto& device = context.device;
    const auto bytes = released_array_bytes(device.info());
    if (!takes_whole_array(context.settings) || device.info().is_gpu
        || device.memory_limit() != Device::no_memory_limit || 3 * bytes <= free_memory())
        return;
    throw InputError(
        fmt::format("setting queue_bytes=device stands for {:.2f} GB on {}, and three buffers of "
                    "this size do not fit; give --set queue_bytes=67108864, or --memory",
                    static_cast<double>(bytes) / 1e9, device.info().id));
}

} // namespace

std::span<const Counter> queue_counters() { return all_counters; }

QueueWalker::QueueWalker(const ChunkTrees& trees, const BuildContext& context)
    : trees_(trees), shape_(context.shape), sizes_(queue_sizes(context.settings, context.device.info())) {
    refuse_large_array(context);
    counts_ = device().allocate(sizes_.groups * 4, "queue counts");
    starts_ = device().allocate((sizes_.groups + 1) * 4, "queue starts");
    totals_ = device().allocate(8, "balance totals");
    idle_ = device().allocate(4, "idle groups");
    const auto rows = first_rows(device(), sizes_.queue_capacity, sizes_.groups * item_words * 4, 0.25);
    const Column queues{"queues", sizes_.groups * item_words * 4};
    queues_ = GrowableBuffer(device(), {queues, queues}, std::max(rows, least_capacity));
}

void QueueWalker::do_compile(const WalkBuild& build) {
    auto defines = trees_.defines(shape_.group_size);
    build.add_to(defines);
    add_defines(sizes_, defines);
    compile_kernel(device(), traverse_, defines);
    const auto compile = [&](auto& kernel, std::uint32_t group_size) {
        Defines own{{"PRECISION", "32"}}; // these kernels have no reals
        define(own, parameters::group_size, group_size);
        compile_kernel(device(), kernel, own);
    };
    compile(scatter_, shape_.group_size);
    compile(plan_, sizes_.balance_group_size);
    if (sizes_.balance == BalanceMethod::serial)
        compile(move_serially_, sizes_.balance_group_size);
    else
        compile(move_, shape_.group_size);
}

std::uint64_t QueueWalker::queue_bytes() const {
    return std::uint64_t{sizes_.groups} * queue_capacity() * item_words * 4;
}

std::uint64_t QueueWalker::total_capacity() const {
    return queue_capacity() == 0 ? 0 : std::uint64_t{sizes_.groups} * (queue_capacity() - 1);
}

bool QueueWalker::do_grow(const Status& status) {
    if (status.counter(STATUS_BODY_PAIRS) > total_capacity()) short_of_queue_ = true;
    if (!short_of_queue_) return false;
    short_of_queue_ = false;
    if (queue_capacity() > MOST_QUEUE_ITEMS / 2) throw DeviceError(too_many_items);
    queues_.reserve(std::max(2 * std::uint64_t{queue_capacity()}, least_capacity));
    return true;
}

void QueueWalker::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[counters::bvtt_nodes.name] += status.counter(STATUS_BVTT_NODES);
    work[counters::seeds.name] += status.counter(STATUS_SEEDS);
    work[balances.name] += balances_;
    work[refills.name] += status.counter(STATUS_REFILLS);
    work[spills.name] += status.counter(STATUS_SPILLS);
    work[own_bytes.name] = queue_bytes();
    work[published_bytes.name] = released_array_bytes(device().info());
}

/// Spreads the roots of body pairs over the queues. The body pairs are already on the device.
void QueueWalker::seed(const WalkTask& task, std::uint32_t first, std::uint32_t most) {
    const StageScope scope(device(), Stage::seed);
    const kernels::balance::ScatterRoots arguments{.items = items(),
                                                   .counts = counts_,
                                                   .queues = sizes_.groups,
                                                   .queue_capacity = queue_capacity(),
                                                   .first = first,
                                                   .most = most,
                                                   .status = task.status.buffer()};
    device().launch(scatter_, {shape_.groups, shape_.group_size}, arguments);
}

/// As in the release: a new host array as large as all queues, with one root at the start of each, uploaded
/// as a whole.
void QueueWalker::upload_whole_queues(std::uint32_t first, std::uint32_t count) {
    const auto words = std::uint64_t{sizes_.groups} * queue_capacity() * item_words;
    std::unique_ptr<std::uint32_t[]> items;
    std::vector<std::uint32_t> counts(sizes_.groups, 0);
    {
        const HostWork work(device(), Stage::preprocess, "queue array");
        items = std::make_unique_for_overwrite<std::uint32_t[]>(words);
        for (std::uint32_t i = 0; i < count; ++i) {
            // If a batch has more roots than there are groups, a queue has several.
            const auto queue = i % sizes_.groups;
            auto* item = &items[(std::uint64_t{queue} * queue_capacity() + counts[queue]++) * item_words];
            item[0] = first + i;
            item[1] = item[2] = 1;
        }
    }
    const StageScope scope(device(), Stage::write);
    device().upload(this->items(), std::as_bytes(std::span(items.get(), words)), 0, true);
    device().upload(counts_, bytes_of(counts), 0, true);
}

void QueueWalker::do_clear_idle() { device().clear(idle_, 4); }

void QueueWalker::traverse(const WalkTask& task) {
    const auto& bodies = trees_.bodies();
    const kernels::gproximity::TraverseQueues arguments{.nodes = trees_.nodes(),
                                                        .trees = trees_.tree_table(),
                                                        .bodies = bodies.row_table(),
                                                        .ids = bodies.ids(),
                                                        .tetrahedra = bodies.topology(),
                                                        .pairs = task.body_pairs,
                                                        .items = items(),
                                                        .counts = counts_,
                                                        .queue_capacity = queue_capacity(),
                                                        .idle = idle_,
                                                        .found = task.answer.pairs.buffer(),
                                                        .capacity = task.answer.pairs.capacity(),
                                                        .status = task.status.buffer()};
    {
        const StageScope scope(device(), Stage::write);
        do_clear_idle();
    }
    const StageScope scope(device(), Stage::traverse);
    device().launch(traverse_, {sizes_.groups, shape_.group_size}, arguments);
}

/// The thresholds are those of both originals: any queue below its initial load, or nearly full.
void QueueWalker::plan_and_move() {
    const auto margin = std::uint64_t{4} * shape_.group_size + sizes_.local_queue;
    const auto high = static_cast<std::uint32_t>(queue_capacity() > margin ? queue_capacity() - margin : 0);
    const auto low = 3 * shape_.group_size;
    const StageScope scope(device(), Stage::balance);
    const kernels::balance::PlanBalance plan{.counts = counts_,
                                             .queues = sizes_.groups,
                                             .low = low,
                                             .high = high,
                                             .starts = starts_,
                                             .totals = totals_};
    device().launch(plan_, {1, sizes_.balance_group_size}, plan);
    const auto move = [&]<class Arguments>(const KernelOf<Arguments>& kernel, Grid grid) {
        device().launch(kernel, grid,
                        Arguments{.from = items(),
                                  .to = target_items(),
                                  .counts = counts_,
                                  .queues = sizes_.groups,
                                  .queue_capacity = queue_capacity(),
                                  .starts = starts_,
                                  .totals = totals_});
    };
    if (sizes_.balance == BalanceMethod::serial)
        move(move_serially_, {1, sizes_.balance_group_size});
    else
        move(move_, {shape_.groups, shape_.group_size});
}

/// Plans and moves. Returns the number of items left, at most MOST_QUEUE_ITEMS, and whether they moved.
std::array<std::uint32_t, 2> QueueWalker::balance() {
    plan_and_move();
    std::array<std::uint32_t, 2> totals{};
    const StageScope scope(device(), Stage::read);
    device().download(totals_, std::as_writable_bytes(std::span(totals)));
    return totals;
}

/// Walks one batch to its end. Returns false if the queues are too small for it.
bool QueueWalker::walk_batch(const WalkTask& task, std::uint32_t first, std::uint32_t count) {
    if (count > total_capacity()) return false;
    if (sizes_.upload == QueueUpload::queues)
        upload_whole_queues(first, count);
    else
        seed(task, first, count);
    while (true) {
        traverse(task);
        do_after_launch();
        const auto [left, moved] = balance();
        if (left >= MOST_QUEUE_ITEMS) throw DeviceError(too_many_items);
        if (left == 0) return true;
        if (moved != 0) {
            side_ = 1 - side_;
            ++balances_;
        }
        if (left > total_capacity()) return false;
    }
}

void QueueWalker::do_launch(const WalkTask& task) {
    balances_ = 0;
    short_of_queue_ = false;
    // The device may have found more body pairs than the queues can store; do_grow checks this.
    const auto most = task.searched ? total_capacity() : std::uint64_t{task.most_pairs()};
    const auto total = static_cast<std::uint32_t>(std::min<std::uint64_t>(task.most_pairs(), most));
    const auto batch = sizes_.batch == 0 ? total : sizes_.batch;
    for (std::uint64_t first = 0; first < total; first += batch) {
        const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(batch, total - first));
        if (!walk_batch(task, static_cast<std::uint32_t>(first), count)) {
            short_of_queue_ = true;
            return;
        }
        if (task.launch_hook != nullptr) task.launch_hook->part_walked();
    }
}

} // namespace tandem
