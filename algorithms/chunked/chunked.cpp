// SPDX-License-Identifier: MIT
#include "algorithms/chunked/chunked.h"

#include "algorithms/kdop_session.h"
#include "algorithms/sources.h"
#include "algorithms/status.clh"
#include "scenes/error.h"

#include <algorithm>
#include <bit>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::uint64_t seed_words = 3;

const std::vector<Parameter> own{
    {"chunk_bytes", "8000", {}, 1, std::int64_t{1} << 30, "memory of a pair of chunks in equation (1)"},
    {"leaves", "0", {}, 0, 16384, "tetrahedra per chunk, a power of two; 0: from chunk_bytes"},
    {"seed_threshold",
     "0",
     {},
     0,
     std::int64_t{1} << 31,
     "chunk pairs per body pair above which seeding climbs a level (the paper's: 1e7); 0: seed_target shared "
     "by the frame's body pairs"},
    {"seed_target",
     "1048576",
     {},
     1,
     std::int64_t{1} << 31,
     "seeds a frame is to have at most, as far as levels allow, when seed_threshold is 0"},
    {"schedule",
     "group",
     {"group", "item"},
     0,
     0,
     "who walks: a work-group the seeds of its batches that overlap, or, as the paper's code, a work-item "
     "every seed a stride apart"},
    {"descent",
     "larger",
     {"larger", "both"},
     0,
     0,
     "what a step of a walk descends: of two nodes of unlike size the larger alone, or always both at once, "
     "as the paper's code"},
    {"root_test",
     "yes",
     {"yes", "no"},
     0,
     0,
     "resident: drop body pairs whose whole volumes are apart before seeding"},
    {"seed_capacity",
     "65536",
     {},
     1,
     std::int64_t{1} << 31,
     "seeds handed down a level there is room for at first"},
};

const std::vector<Preset> all_presets{
    {"resident", "everything resident, body pairs included, one wait per frame", {{"broad", "device"}}},
    {"published",
     "the paper: k = 8, 8000-byte chunks, everything converted and transferred in every frame",
     {{"k", "8"},
      {"residency", "published"},
      {"schedule", "item"},
      {"descent", "both"},
      {"seed_threshold", "10000000"},
      {"group_size", "64"},
      {"root_test", "no"}}},
};

std::uint32_t leaves_of(const Settings& settings) {
    const auto given = static_cast<std::uint32_t>(integer(settings, "leaves"));
    if (given == 0)
        return leaves_of_chunk_bytes(static_cast<std::uint64_t>(integer(settings, "chunk_bytes")),
                                     static_cast<int>(integer(settings, "k")));
    if (given < 2 || !std::has_single_bit(given))
        throw InputError(
            fmt::format("setting leaves={} is impossible; give a power of two from 2 to 16384, or 0", given));
    return given;
}

class ChunkedSession final : public KdopSession {
public:
    ChunkedSession(Device& device, const Scene& scene, const Settings& settings)
        : KdopSession(device, scene, settings, leaves_of(settings)),
          threshold_(static_cast<std::uint64_t>(integer(settings, "seed_threshold"))),
          target_(static_cast<std::uint64_t>(integer(settings, "seed_target"))) {
        do_compile(defines());
        find_top_level();
        reserve_seeds(static_cast<std::uint64_t>(integer(settings, "seed_capacity")));
    }

private:
    void do_walk(std::span<const BodyPair> pairs) override;
    bool do_grow(const Status& status) override;
    void do_compile(const Defines& defines) override;

    std::uint32_t seed_level(std::uint32_t a, std::uint32_t b, std::uint64_t pair_count) const;
    void find_top_level();
    void reserve_seeds(std::uint64_t count);
    void reserve_starts(std::uint64_t pairs);
    void seed_on_device(std::uint32_t pair_count);
    void traverse(std::uint32_t level, std::uint32_t pair_count);
    void walk_published(std::span<const BodyPair> pairs);
    bool try_published(std::span<const BodyPair> pairs);
    std::vector<std::uint32_t> seeds_of_level(std::span<const BodyPair> pairs, std::uint32_t level) const;

    std::uint64_t threshold_; ///< 0: target_ shared by the body pairs
    std::uint64_t target_;
    std::uint32_t top_level_ = 0; ///< the highest level any pair of this scene's meshes is seeded at
    std::uint64_t seed_capacity_ = 0;
    std::uint64_t start_room_ = 0;
    std::array<Buffer, 2> handed_; ///< seeds handed down to even and odd levels
    Buffer starts_;
    Kernel count_kernel_, scan_kernel_, traverse_kernel_;
};

void ChunkedSession::do_compile(const Defines& common) {
    auto defines = common;
    defines["SEED_THRESHOLD"] = std::to_string(threshold_);
    defines["SEED_TARGET"] = std::to_string(target_);
    defines["DESCEND_LARGER"] = settings().at("descent") == "larger" ? "1" : "0";
    // Body pairs found on the device have passed the same test.
    defines["ROOT_TEST"] = settings().at("root_test") == "yes" && !finds_pairs() ? "1" : "0";
    const auto& source = kernel_source("algorithms/chunked/chunked.cl");
    count_kernel_ = device().compile(source, "count_seeds", defines);
    scan_kernel_ = device().compile(source, "scan_seeds", defines);
    traverse_kernel_ = device().compile(
        source, settings().at("schedule") == "group" ? "traverse_in_groups" : "traverse", defines);
}

/// The rule of seed_level in chunked.cl, for the host.
std::uint32_t ChunkedSession::seed_level(std::uint32_t a, std::uint32_t b, std::uint64_t pair_count) const {
    const auto threshold = threshold_ != 0 ? threshold_ : target_ / std::max<std::uint64_t>(pair_count, 1);
    const auto& levels_a = scene().levels(a);
    const auto& levels_b = scene().levels(b);
    const auto top = static_cast<std::uint32_t>(std::min(levels_a.size(), levels_b.size()) - 1);
    std::uint32_t level = 0;
    while (level < top && std::uint64_t{levels_a[level].chunks} * levels_b[level].chunks > threshold) ++level;
    return level;
}

/// Which levels can be seeded depends on meshes and the number of bodies only, so that the sequence of
/// launches is fixed beforehand.
void ChunkedSession::find_top_level() {
    const std::uint64_t bodies = scene().body_count();
    const auto most_pairs = bodies * (bodies - 1) / 2;
    std::map<const std::vector<Level>*, std::uint32_t> first_with; // one body for each mesh
    for (std::uint32_t body = 0; body < scene().body_count(); ++body)
        first_with.emplace(&scene().levels(body), body);
    for (const auto& [levels_a, a] : first_with)
        for (const auto& [levels_b, b] : first_with)
            top_level_ = std::max(top_level_, seed_level(a, b, most_pairs));
}

void ChunkedSession::reserve_seeds(std::uint64_t count) {
    seed_capacity_ = count;
    for (auto& buffer : handed_) {
        buffer = {};
        buffer = device().allocate((top_level_ > 0 || published() ? count : 1) * seed_words * 4, "seeds");
    }
}

void ChunkedSession::reserve_starts(std::uint64_t pairs) {
    if (starts_ && pairs <= start_room_) return;
    start_room_ = pairs + pairs / 4;
    starts_ = {};
    starts_ = device().allocate((start_room_ + 1) * (top_level_ + 1) * 8, "seed starts");
}

bool ChunkedSession::do_grow(const Status& status) {
    std::uint64_t most = 0;
    for (std::uint32_t level = 0; level < top_level_; ++level)
        most = std::max(most, status.counter(STATUS_LEVELS + 2 * level));
    if (most <= seed_capacity_) return false;
    reserve_seeds(most + most / 8);
    return true;
}

void ChunkedSession::seed_on_device(std::uint32_t pair_count) {
    const StageScope scope(device(), Stage::seed);
    reserve_starts(pair_count);
    const auto group = scene().group_size();
    const std::array<Argument, 8> count{scene().nodes(), scene().bodies(), scene().level_table(),
                                        pairs(),         pair_count,       top_level_ + 1,
                                        starts_,         status()};
    const auto groups_needed = (std::uint64_t{pair_count} + group - 1) / group;
    device().launch(count_kernel_, {std::min<std::uint64_t>(groups_needed, groups()), group}, count);
    const std::array<Argument, 3> scan{starts_, pair_count, status()};
    device().launch(scan_kernel_, {top_level_ + 1, group}, scan);
}

void ChunkedSession::traverse(std::uint32_t level, std::uint32_t pair_count) {
    const StageScope scope(device(), Stage::traverse);
    const auto room = static_cast<std::uint32_t>(seed_capacity_);
    const auto& handed = handed_[level % 2];
    const auto& below = handed_[(level + 1) % 2];
    const std::array<Argument, 15> arguments{scene().nodes(),
                                             scene().bodies(),
                                             scene().level_table(),
                                             scene().tetrahedron_ids(),
                                             pairs(),
                                             pair_count,
                                             level,
                                             starts_,
                                             handed,
                                             room,
                                             below,
                                             room,
                                             found(),
                                             static_cast<std::uint32_t>(capacity()),
                                             status()};
    device().launch(traverse_kernel_, {groups(), scene().group_size()}, arguments);
}

void ChunkedSession::do_walk(std::span<const BodyPair> body_pairs) {
    if (published()) {
        walk_published(body_pairs);
        return;
    }
    const auto count = pair_count(body_pairs);
    seed_on_device(count);
    for (std::uint32_t level = top_level_ + 1; level-- > 0;) traverse(level, count);
}

std::vector<std::uint32_t> ChunkedSession::seeds_of_level(std::span<const BodyPair> body_pairs,
                                                          std::uint32_t level) const {
    std::vector<std::uint32_t> seeds;
    for (std::uint32_t pair = 0; pair < body_pairs.size(); ++pair) {
        const auto [a, b] = body_pairs[pair];
        if (seed_level(a, b, body_pairs.size()) != level) continue;
        for (std::uint32_t i = 0; i < scene().levels(a)[level].chunks; ++i)
            for (std::uint32_t j = 0; j < scene().levels(b)[level].chunks; ++j)
                seeds.insert(seeds.end(), {pair, i, j});
    }
    return seeds;
}

/// The paper's schedule: seeds made and uploaded by the host, counters written before and read after every
/// launch, contacts after every launch that found pairs (tvcg18.md 1.2 and 3).
void ChunkedSession::walk_published(std::span<const BodyPair> body_pairs) {
    reserve_starts(0);
    device().clear(starts_, starts_.bytes());
    while (!try_published(body_pairs)) clear_status();
}

/// False when a seed buffer was too small; it has grown, and the walk starts again.
bool ChunkedSession::try_published(std::span<const BodyPair> body_pairs) {
    std::uint64_t found_before = 0;
    std::uint64_t handed = 0;
    for (std::uint32_t level = top_level_ + 1; level-- > 0;) {
        std::vector<std::uint32_t> seeds;
        {
            const HostWork work(device(), Stage::preprocess, "make seeds");
            seeds = seeds_of_level(body_pairs, level);
        }
        const auto total = handed + seeds.size() / seed_words;
        if (total > seed_capacity_) {
            reserve_seeds(total + total / 8);
            return false;
        }
        {
            const StageScope scope(device(), Stage::write);
            device().upload(handed_[level % 2], bytes_of(seeds), handed * seed_words * 4, true);
            set_status(STATUS_LEVELS + 2 * level, total);
        }
        traverse(level, 0);
        found_before = publish_contacts(found_before);
        if (level > 0) handed = read_status().counter(STATUS_LEVELS + 2 * (level - 1));
    }
    return true;
}

class Chunked : public Traversal {
public:
    std::string_view name() const override { return "chunked"; }
    std::string_view summary() const override {
        return "chunked static scheduler (Schmidtke and Erleben): all chunk pairs seeded, one walk per "
               "work-item";
    }
    std::span<const Parameter> parameters() const override {
        static const auto all = kdop_parameters(own);
        return all;
    }
    std::span<const Preset> presets() const override { return all_presets; }

private:
    void do_check(const Settings& settings, const DeviceInfo& info) const override {
        effective(settings, info);
        leaves_of(settings);
    }
    std::unique_ptr<Session> do_prepare(Device& device, const Scene& scene,
                                        const Settings& settings) const override {
        return std::make_unique<ChunkedSession>(device, scene, settings);
    }
};

} // namespace

const Traversal& chunked() {
    static const Chunked instance;
    return instance;
}

} // namespace tandem
