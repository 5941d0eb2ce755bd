// SPDX-License-Identifier: MIT
#include "algorithms/gproximity/gproximity.h"

#include "algorithms/gproximity/gproximity_settings.h"
#include "algorithms/gproximity/queues.clh"
#include "algorithms/kdop_session.h"
#include "algorithms/sources.h"
#include "algorithms/status.clh"
#include "scenes/error.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace tandem {

namespace {

constexpr std::uint64_t item_words = 3;
constexpr auto too_many_items =
    "gproximity: 2^31 node pairs or more wait in its queues, past what it counts; set batch, or take chunked";

/// One chunk over all tetrahedra of the largest mesh: a plain hierarchy per body.
std::uint32_t whole_mesh(const Scene& scene) {
    std::uint32_t most = 2;
    for (const auto& mesh : scene.meshes)
        most = std::max(most, static_cast<std::uint32_t>(mesh.tetrahedra.size()));
    return std::bit_ceil(most);
}

class GproximitySession final : public KdopSession {
public:
    GproximitySession(Device& device, const Scene& scene, const Settings& given)
        : KdopSession(device, scene, given, whole_mesh(scene)),
          sizes_(queue_sizes(settings(), device.info(), this->scene().group_size())),
          refill_(settings().at("refill") == "yes"),
          full_exit_(settings().at("full_exit") == "yes"),
          serial_(settings().at("balance") == "serial"),
          upload_queues_(settings().at("upload") == "queues") {
        do_compile(defines());
        counts_ = device.allocate(sizes_.groups * 4, "queue counts");
        starts_ = device.allocate((sizes_.groups + 1) * 4, "queue starts");
        totals_ = device.allocate(8, "balance totals");
        idle_ = device.allocate(4, "idle groups");
        reserve_queues();
    }

private:
    void do_walk(std::span<const BodyPair> pairs) override;
    bool do_grow(const Status& status) override;
    void do_compile(const Defines& defines) override;
    void do_report(Work& work) const override;

    std::uint64_t queue_bytes() const;
    std::uint64_t queue_room() const;
    void reserve_queues();
    void seed(std::uint32_t first, std::uint32_t count);
    void upload_whole_queues(std::uint32_t first, std::uint32_t count);
    bool walk_batch(std::uint32_t first, std::uint32_t count);
    void traverse();
    std::array<std::uint32_t, 2> balance();
    void read_counts();

    QueueSizes sizes_;
    bool refill_, full_exit_, serial_, upload_queues_;
    bool short_of_queue_ = false;
    std::uint64_t balances_ = 0;
    std::array<Buffer, 2> items_; ///< ping and pong
    Buffer counts_, starts_, totals_, idle_;
    Kernel scatter_, traverse_, plan_, move_;
};

void GproximitySession::do_compile(const Defines& common) {
    const auto& source = kernel_source("algorithms/gproximity/gproximity.cl");
    auto defines = common;
    defines["LOCAL_QUEUE"] = std::to_string(sizes_.local_queue);
    defines["INITIAL_ITEMS"] = std::to_string(sizes_.initial_items);
    defines["IDLE_LIMIT"] = std::to_string(sizes_.idle_limit);
    defines["REFILL"] = refill_ ? "1" : "0";
    defines["FULL_EXIT"] = full_exit_ ? "1" : "0";
    scatter_ = device().compile(source, "scatter_roots", defines);
    traverse_ = device().compile(source, "traverse_queues", defines);
    if (!serial_) move_ = device().compile(source, "move_balance", defines);
    defines["GROUP_SIZE"] = std::to_string(sizes_.balance_group_size);
    plan_ = device().compile(source, "plan_balance", defines);
    if (serial_) move_ = device().compile(source, "move_balance_serially", defines);
}

std::uint64_t GproximitySession::queue_bytes() const {
    return std::uint64_t{sizes_.groups} * sizes_.queue_capacity * item_words * 4;
}

/// Items that may wait in all queues together.
std::uint64_t GproximitySession::queue_room() const {
    return std::uint64_t{sizes_.groups} * (sizes_.queue_capacity - 1);
}

/// The release took min(largest allocation, a quarter of the memory) for one array (tvcg18.md 2.1).
void GproximitySession::do_report(Work& work) const {
    const auto& info = scene().device().info();
    work.balances = balances_;
    work.queue_bytes = queue_bytes();
    work.published_queue_bytes = std::min(info.max_allocation, info.global_bytes / 4);
}

void GproximitySession::reserve_queues() {
    const auto bytes = queue_bytes();
    for (auto& buffer : items_) {
        buffer = {};
        buffer = device().allocate(bytes, "queues");
    }
}

bool GproximitySession::do_grow(const Status& status) {
    if (finds_pairs() && status.counter(STATUS_BODY_PAIRS) > queue_room()) short_of_queue_ = true;
    if (!short_of_queue_) return false;
    short_of_queue_ = false;
    if (sizes_.queue_capacity > MOST_QUEUE_ITEMS / 2) throw DeviceError(too_many_items);
    sizes_.queue_capacity *= 2;
    reserve_queues();
    return true;
}

/// Spreads the roots of body pairs over the queues; the pairs themselves were uploaded with the frame.
void GproximitySession::seed(std::uint32_t first, std::uint32_t count) {
    const StageScope scope(device(), Stage::seed);
    const std::array<Argument, 7> arguments{items_[0], counts_, sizes_.groups, sizes_.queue_capacity,
                                            first,     count,   status()};
    device().launch(scatter_, {groups(), scene().group_size()}, arguments);
}

/// What the release did: a fresh host array as large as all queues, one root at the start of each, uploaded
/// whole.
void GproximitySession::upload_whole_queues(std::uint32_t first, std::uint32_t count) {
    const auto words = std::uint64_t{sizes_.groups} * sizes_.queue_capacity * item_words;
    std::unique_ptr<std::uint32_t[]> items;
    std::vector<std::uint32_t> counts(sizes_.groups, 0);
    {
        const HostWork work(device(), Stage::preprocess, "queue array");
        items = std::make_unique_for_overwrite<std::uint32_t[]>(words);
        for (std::uint32_t i = 0; i < count; ++i) {
            // A batch may be larger than the groups: roots then lie one above the other.
            const auto queue = i % sizes_.groups;
            auto* item =
                &items[(std::uint64_t{queue} * sizes_.queue_capacity + counts[queue]++) * item_words];
            item[0] = first + i;
            item[1] = item[2] = 1;
        }
    }
    const StageScope scope(device(), Stage::write);
    device().upload(items_[0], std::as_bytes(std::span(items.get(), words)), 0, true);
    device().upload(counts_, bytes_of(counts), 0, true);
}

void GproximitySession::traverse() {
    const std::array<Argument, 11> arguments{scene().nodes(),
                                             scene().bodies(),
                                             scene().tetrahedron_ids(),
                                             pairs(),
                                             items_[0],
                                             counts_,
                                             sizes_.queue_capacity,
                                             idle_,
                                             found(),
                                             static_cast<std::uint32_t>(capacity()),
                                             status()};
    if (published()) {
        const StageScope scope(device(), Stage::write);
        const std::uint32_t zero = 0;
        device().upload(idle_, std::as_bytes(std::span(&zero, 1)), 0, true);
    } else {
        device().clear(idle_, 4);
    }
    const StageScope scope(device(), Stage::traverse);
    device().launch(traverse_, {sizes_.groups, scene().group_size()}, arguments);
}

/// Plans and moves; returns {items left, at most MOST_QUEUE_ITEMS, and whether they moved}. The thresholds
/// are those of both originals: any queue below its initial load, or nearly full.
std::array<std::uint32_t, 2> GproximitySession::balance() {
    const auto margin = std::uint64_t{4} * scene().group_size() + sizes_.local_queue;
    const auto high =
        static_cast<std::uint32_t>(sizes_.queue_capacity > margin ? sizes_.queue_capacity - margin : 0);
    const auto low = 3 * scene().group_size();
    {
        const StageScope scope(device(), Stage::balance);
        const std::array<Argument, 6> plan{counts_, sizes_.groups, low, high, starts_, totals_};
        device().launch(plan_, {1, sizes_.balance_group_size}, plan);
        const std::array<Argument, 7> move{
            items_[0], items_[1], counts_, sizes_.groups, sizes_.queue_capacity, starts_, totals_};
        if (serial_)
            device().launch(move_, {1, sizes_.balance_group_size}, move);
        else
            device().launch(move_, {groups(), scene().group_size()}, move);
    }
    std::array<std::uint32_t, 2> totals{};
    const StageScope scope(device(), Stage::read);
    device().download(totals_, std::as_writable_bytes(std::span(totals)));
    return totals;
}

/// The release reads the queues' counts after every launch, to look for full ones.
void GproximitySession::read_counts() {
    const StageScope scope(device(), Stage::read);
    std::vector<std::uint32_t> counts(sizes_.groups);
    device().download(counts_, std::as_writable_bytes(std::span(counts)));
}

/// Walks one batch to its end; false when the queues are too small for it.
bool GproximitySession::walk_batch(std::uint32_t first, std::uint32_t count) {
    if (count > queue_room()) return false;
    if (upload_queues_)
        upload_whole_queues(first, count);
    else
        seed(first, count);
    while (true) {
        traverse();
        if (published()) read_counts();
        const auto [left, moved] = balance();
        if (left >= MOST_QUEUE_ITEMS) throw DeviceError(too_many_items);
        if (left == 0) return true;
        if (moved != 0) {
            std::swap(items_[0], items_[1]);
            ++balances_;
        }
        if (left > queue_room()) return false;
    }
}

void GproximitySession::do_walk(std::span<const BodyPair> body_pairs) {
    balances_ = 0;
    if (finds_pairs()) { // as many as fit; do_grow looks whether these were all
        const auto most = std::min<std::uint64_t>(pair_count(body_pairs), queue_room());
        short_of_queue_ = !walk_batch(0, static_cast<std::uint32_t>(most));
        return;
    }
    const auto total = pair_count(body_pairs);
    const auto batch = sizes_.batch == 0 ? total : sizes_.batch;
    std::uint64_t found_before = 0;
    for (std::uint32_t first = 0; first < total; first += batch) {
        if (!walk_batch(first, std::min(batch, total - first))) {
            short_of_queue_ = true;
            return;
        }
        if (published()) found_before = publish_contacts(found_before);
    }
}

class Gproximity : public Traversal {
public:
    std::string_view name() const override { return "gproximity"; }
    std::string_view summary() const override {
        return "gProximity (Lauterbach, Mo and Manocha): one hierarchy per body, work queues balanced "
               "between launches";
    }
    std::span<const Parameter> parameters() const override {
        static const auto all = kdop_parameters(gproximity_parameters());
        return all;
    }
    std::span<const Preset> presets() const override { return gproximity_presets(); }

private:
    void do_check(const Settings& settings, const DeviceInfo& info) const override {
        const auto fitting = effective(settings, info);
        const auto sizes =
            queue_sizes(fitting, info, static_cast<std::uint32_t>(integer(fitting, "group_size")));
        if (fitting.at("broad") == "device" && (sizes.batch != 0 || fitting.at("upload") == "queues"))
            throw InputError(
                "setting broad=device goes with batch=0 and upload=seeds only: the host makes "
                "batches and queues, and would have to know the body pairs; choose broad=sphere");
    }
    std::unique_ptr<Session> do_prepare(Device& device, const Scene& scene,
                                        const Settings& settings) const override {
        return std::make_unique<GproximitySession>(device, scene, settings);
    }
};

} // namespace

const Traversal& gproximity() {
    static const Gproximity instance;
    return instance;
}

} // namespace tandem
