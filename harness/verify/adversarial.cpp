// SPDX-License-Identifier: MIT
#include "harness/verify/adversarial.h"

#include "algorithms/answer/pair_list.h"
#include "geometry/contact_truth.h"
#include "harness/verify/oracle/frame_truth.h"
#include "base/parallel.h"
#include "base/error.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace tandem {

namespace {

constexpr std::uint32_t leaves_a_chunk = 32;
constexpr std::uint32_t group_size = 128;
constexpr std::uint64_t most_of_a_pose = 4096; ///< limits a batch, so that rigid families have many poses
constexpr std::size_t part_size = 1024;        ///< pairs of one parallel task

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

Relation relation_of(Known known) {
    return known == Known::disjoint   ? Relation::disjoint
           : known == Known::touching ? Relation::touching
                                      : Relation::overlapping;
}

/// Converts to double, which is exact.
TetraCorners widened(const FloatCorners& corners) {
    TetraCorners result;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned axis = 0; axis < 3; ++axis) result[i][axis] = static_cast<double>(corners[i][axis]);
    return result;
}

/// Vertices or a pose, and the truth of the pairs.
struct Batch {
    Frame frame;
    std::vector<Relation> truth;
    std::atomic<std::uint64_t> decided = 0, clipped = 0, contradictions = 0;
};

/// Tests the pairs of one family at one difficulty, batch by batch, on every cell.
class Runner {
public:
    Runner(const HardFamily& family, std::span<const AdversarialCell> cells,
           const AdversarialOptions& options, double difficulty, std::uint64_t seed, std::uint64_t batch_size)
        : family_(family),
          options_(options),
          difficulty_(difficulty),
          seed_(seed),
          batch_size_(batch_size),
          scene_(hard_pair_scene(family, seed, difficulty, {batch_size, batch_size})) {
        std::vector<Pair> list(batch_size);
        for (std::uint32_t i = 0; i < batch_size; ++i) list[i] = {0, i, 1, i};
        list_ = std::move(list);
        for (const auto& cell : cells) {
            const auto group = std::min(group_size, cell.device->info().max_group_size);
            bodies_.push_back(
                std::make_unique<Bodies>(*cell.device, scene_, cell.geometry, Bodies::Sharing::by_mesh));
            trees_.push_back(std::make_unique<ChunkTrees>(*bodies_.back(), leaves_a_chunk, group));
            lists_.push_back(std::make_unique<PairList>(*trees_.back(), list_));
        }
    }

    /// Runs batch number `number` of this difficulty.
    void run(std::uint64_t number, AdversarialTally& tally) {
        auto begin = Clock::now();
        Batch batch;
        make(batch, number);
        tally.truth_seconds += seconds_since(begin);
        begin = Clock::now();
        std::vector<std::vector<std::uint8_t>> found;
        for (std::size_t cell = 0; cell < lists_.size(); ++cell) {
            bodies_[cell]->update(batch.frame);
            trees_[cell]->refit(batch.frame);
            found.push_back(lists_[cell]->run());
        }
        tally.test_seconds += seconds_since(begin);
        compare(batch, found, number, tally);
    }

private:
    /// A pose moves all pairs of a batch, so that the oracle decides their world vertices. Pairs in world
    /// coordinates have a known relation, or the oracle decides them one by one.
    void make(Batch& batch, std::uint64_t number) {
        if (family_.pose != nullptr)
            make_posed(batch, number);
        else
            make_pairs(batch, number);
    }

    void make_posed(Batch& batch, std::uint64_t number) {
        batch.frame = scene_.frame(number);
        for (const auto& decision : decide_pairs(scene_, batch.frame, Precision::fp32, list_))
            batch.truth.push_back(decision.relation);
        batch.decided = batch.truth.size();
    }

    void make_pairs(Batch& batch, std::uint64_t number) {
        batch.frame.poses.resize(2);
        batch.frame.deformed.assign(2, std::vector<Eigen::Vector3d>(4 * batch_size_));
        batch.truth.resize(batch_size_);
        parallel_for((batch_size_ + part_size - 1) / part_size, [&](std::size_t index) {
            const auto end = std::min<std::uint64_t>(batch_size_, (index + 1) * part_size);
            for (std::uint64_t i = index * part_size; i < end; ++i)
                make_pair(batch, number * batch_size_ + i, i);
        });
    }

    /// Stores pair `index` of the family in `slot` of the batch. The oracle also decides a sample of the
    /// pairs with a known relation: a contradiction is an error of the construction or of the oracle.
    void make_pair(Batch& batch, std::uint64_t index, std::uint64_t slot) const {
        const auto pair = hard_pair(family_, seed_, index, difficulty_);
        for (unsigned i = 0; i < 4; ++i)
            for (unsigned axis = 0; axis < 3; ++axis) {
                batch.frame.deformed[0][4 * slot + i][axis] = static_cast<double>(pair.a[i][axis]);
                batch.frame.deformed[1][4 * slot + i][axis] = static_cast<double>(pair.b[i][axis]);
            }
        const bool open = pair.known == Known::open;
        if (!open) batch.truth[slot] = relation_of(pair.known);
        const bool clips = family_.truth == HardTruth::geometry && index < options_.clipped;
        if (!open && !clips && index % options_.sample != 0) return;
        const auto decided = clips ? clipped(batch, pair) : relation(widened(pair.a), widened(pair.b));
        ++batch.decided;
        if (open)
            batch.truth[slot] = decided;
        else if (decided != batch.truth[slot])
            ++batch.contradictions;
    }

    /// The relation according to the exact intersection, which shares only the facets with the decision.
    /// Invalid when the pair has no volume.
    static Relation clipped(Batch& batch, const HardPair& pair) {
        const auto truth = contact_truth(widened(pair.a), widened(pair.b));
        ++batch.clipped;
        if (!truth) return Relation::invalid;
        return truth->volume > 0         ? Relation::overlapping
               : truth->vertices.empty() ? Relation::disjoint
                                         : Relation::touching;
    }

    void compare(const Batch& batch, const std::vector<std::vector<std::uint8_t>>& found,
                 std::uint64_t number, AdversarialTally& tally) const {
        tally.pairs += batch_size_;
        tally.decided += batch.decided;
        tally.clipped += batch.clipped;
        tally.contradictions += batch.contradictions;
        for (std::size_t i = 0; i < batch.truth.size(); ++i) {
            const bool intersects = batch.truth[i] != Relation::disjoint;
            tally.touching += batch.truth[i] == Relation::touching ? 1 : 0;
            tally.overlapping += batch.truth[i] == Relation::overlapping ? 1 : 0;
            for (std::size_t cell = 0; cell < found.size(); ++cell) {
                const bool reported = found[cell][i] != 0;
                tally.missed[cell] += intersects && !reported ? 1 : 0;
                tally.false_pairs[cell] += reported && !intersects ? 1 : 0;
                if (intersects && !reported && !tally.first)
                    tally.first = {cell, difficulty_, seed_, number * batch_size_ + i};
            }
        }
    }

    const HardFamily& family_;
    const AdversarialOptions& options_;
    double difficulty_;
    std::uint64_t seed_;
    std::uint64_t batch_size_;
    Scene scene_;
    std::vector<Pair> list_;
    std::vector<std::unique_ptr<Bodies>> bodies_;
    std::vector<std::unique_ptr<ChunkTrees>> trees_;
    std::vector<std::unique_ptr<PairList>> lists_;
};

/// The geometric mean when both are positive; clamped, because rounding could exceed the limits.
double midpoint(double low, double high) {
    return low > 0 ? std::clamp(std::sqrt(low) * std::sqrt(high), low, high) : 0.5 * (low + high);
}

} // namespace

bool AdversarialTally::ok() const {
    return contradictions == 0 && std::accumulate(missed.begin(), missed.end(), std::uint64_t{0}) == 0;
}

void AdversarialTally::add(const AdversarialTally& other) {
    pairs += other.pairs;
    touching += other.touching;
    overlapping += other.overlapping;
    decided += other.decided;
    clipped += other.clipped;
    contradictions += other.contradictions;
    missed.resize(other.missed.size());
    false_pairs.resize(other.false_pairs.size());
    for (std::size_t cell = 0; cell < missed.size(); ++cell) {
        missed[cell] += other.missed[cell];
        false_pairs[cell] += other.false_pairs[cell];
    }
    if (!first) first = other.first;
    truth_seconds += other.truth_seconds;
    test_seconds += other.test_seconds;
}

bool is_adversarial(const HardFamily& family) {
    return family.pair != nullptr && family.name != "not-finite";
}

std::array<double, 5> difficulties_of(const HardFamily& family) {
    const auto& [meaning, least, most, initial] = family.knob;
    return {least, midpoint(least, initial), initial, midpoint(initial, most), most};
}

AdversarialTally run_adversarial(const HardFamily& family, std::span<const AdversarialCell> cells,
                                 const AdversarialOptions& options) {
    if (!is_adversarial(family))
        throw InputError(
            fmt::format("hard:{} has no pairs of its own; name a family of finite pairs", family.name));
    AdversarialTally tally;
    tally.missed.assign(cells.size(), 0);
    tally.false_pairs.assign(cells.size(), 0);
    const auto difficulties = difficulties_of(family);
    const auto each = (options.pairs + difficulties.size() - 1) / difficulties.size();
    const auto most = family.pose != nullptr ? std::min(options.batch, most_of_a_pose) : options.batch;
    const auto batches = std::max<std::uint64_t>(1, (each + most - 1) / most);
    const auto batch_size = std::max<std::uint64_t>(1, (each + batches - 1) / batches);
    auto seed = options.seed * difficulties.size(); // a seed for each, because difficulties may be equal
    for (const double difficulty : difficulties) {
        Runner runner(family, cells, options, difficulty, seed++, batch_size);
        for (std::uint64_t number = 0; number < batches; ++number) runner.run(number, tally);
    }
    return tally;
}

} // namespace tandem
