// SPDX-License-Identifier: MIT
#include "algorithms/baselines/embree/embree_walker.h"

#include "algorithms/answer/digest.h"
#include "algorithms/baselines/embree/embree_stages.h"
#include "algorithms/baselines/embree/native_kernel.h"

#include <algorithm>
#include <atomic>
#include <tbb/parallel_for.h>

namespace tandem {

namespace {

constexpr const char* collide_entry = "collide_embree";
[[maybe_unused]] const bool collide_listed = list_native<&EmbreeWalker::run>(collide_entry);

constexpr std::size_t status_leaf_tests = STATUS_OWN;

/// Adds to a 64-bit counter of the status, from any of Embree's threads. Returns the previous low word.
std::uint32_t add(std::uint32_t* status, std::size_t word, std::uint64_t value) {
    const auto low = static_cast<std::uint32_t>(value);
    const auto before = std::atomic_ref(status[word]).fetch_add(low, std::memory_order_relaxed);
    const auto high = static_cast<std::uint32_t>(value >> 32) + (before + low < before ? 1u : 0u);
    if (high != 0) std::atomic_ref(status[word + 1]).fetch_add(high, std::memory_order_relaxed);
    return before;
}

std::uint64_t counter(const std::uint32_t* status, std::size_t word) {
    return status[word] | std::uint64_t{status[word + 1]} << 32;
}

/// As starts_beyond in directions.clh: touching overlaps.
template<bool tolerant>
bool starts_beyond(float lower, float upper) {
    return tolerant ? lower - upper > published_tolerance : lower > upper;
}

/// Without branches: the outcome for Embree's pairs is unpredictable.
template<bool tolerant>
bool overlap(const EmbreeTrees::Box& a, const EmbreeTrees::Box& b) {
    bool apart = false;
    for (std::size_t axis = 0; axis < 3; ++axis)
        apart = apart | starts_beyond<tolerant>(a.lower[axis], b.upper[axis])
                | starts_beyond<tolerant>(b.lower[axis], a.upper[axis]);
    return !apart;
}

} // namespace

struct EmbreeWalker::PairTask {
    const EmbreeWalker& walker;
    std::uint32_t a, b;
    const EmbreeTrees::Box* boxes_a;
    const EmbreeTrees::Box* boxes_b;
    std::uint32_t* found;
    std::uint32_t capacity;
    std::uint32_t* status;
    std::uint32_t window_first, window_end; ///< range of items of body a
    bool in_slots;                          ///< PairLayout::slots
    std::uint32_t first_a, first_b;         ///< the bodies' first slots

    void emit(std::span<const RTCCollision> pairs) const;
    void write(std::span<const RTCCollision> pairs) const;
    bool keep_self_pair(RTCCollision& pair) const;
};

/// keep_self_pair of self.clh. Embree reports both orders of two leaves.
bool EmbreeWalker::PairTask::keep_self_pair(RTCCollision& pair) const {
    if (pair.primID0 >= pair.primID1) return false;
    const auto& mesh = walker.trees_.bodies().mesh(a);
    const auto vertices_of = [&](std::size_t item) {
        return std::span(mesh.topology()).subspan(4 * item, 4);
    };
    const auto other = vertices_of(pair.primID1);
    for (const auto vertex : vertices_of(pair.primID0))
        if (std::ranges::find(other, vertex) != other.end()) return false;
    if (mesh.ids[pair.primID0] > mesh.ids[pair.primID1]) std::swap(pair.primID0, pair.primID1);
    return true;
}

/// Past `capacity` the counter still counts, and nothing is written.
void EmbreeWalker::PairTask::write(std::span<const RTCCollision> pairs) const {
    std::uint64_t row = add(status, STATUS_PAIRS, pairs.size());
    for (const auto& pair : pairs) {
        if (row >= capacity) return;
        if (in_slots) {
            found[2 * row] = first_a + pair.primID0;
            found[2 * row + 1] = first_b + pair.primID1;
        } else {
            const std::array<std::uint32_t, 4> words{a, b, pair.primID0, pair.primID1};
            std::copy(words.begin(), words.end(), found + row * words.size());
        }
        ++row;
    }
}

void EmbreeWalker::PairTask::emit(std::span<const RTCCollision> pairs) const {
    if (has_pairs(walker.build_.output)) {
        write(pairs);
        return;
    }
    add(status, STATUS_PAIRS, pairs.size());
    if (walker.build_.output == Output::count) return;
    const auto& bodies = walker.trees_.bodies();
    Digest digest;
    for (const auto& pair : pairs)
        digest += digest_of(Pair{a, bodies.mesh(a).ids[pair.primID0], b, bodies.mesh(b).ids[pair.primID1]});
    add(status, STATUS_DIGEST_A, digest.a);
    add(status, STATUS_DIGEST_B, digest.b);
}

/// Receives all pairs of two leaves of Embree's trees whose boxes overlap, from any of Embree's threads.
template<bool tolerant>
void EmbreeWalker::test_leaves(void* task, RTCCollision* collisions, unsigned count) {
    const auto& self = *static_cast<const PairTask*>(task);
    std::size_t kept = 0;
    const bool is_self = self.a == self.b;
    for (unsigned i = 0; i < count; ++i) {
        const auto pair = collisions[i];
        const auto item = pair.primID0;
        const bool is_in_window = (item >= self.window_first) & (item < self.window_end);
        collisions[kept] = pair;
        const bool overlaps =
            is_in_window & overlap<tolerant>(self.boxes_a[item], self.boxes_b[pair.primID1]);
        if (is_self && overlaps && !self.keep_self_pair(collisions[kept])) continue;
        kept += overlaps;
    }
    if (kept > 0) self.emit({collisions, kept});
    if (self.walker.build_.counting) add(self.status, status_leaf_tests, count);
}

EmbreeWalker::EmbreeWalker(EmbreeTrees& trees, const BuildContext& context)
    : trees_(trees),
      leaf_test_(context.settings[parameters::rounding] == Rounding::published ? test_leaves<true>
                                                                               : test_leaves<false>),
      kernel_(compile_native(context.device, collide_entry)),
      self_(context.device.adopt(this, sizeof(*this), "Embree's walk")) {}

void EmbreeWalker::run(const std::uint32_t* body_pairs, std::uint32_t pair_capacity, std::uint32_t* found,
                       std::uint32_t capacity, std::uint32_t* status, const EmbreeWalker* walker) {
    const auto& self = *walker;
    auto& trees = self.trees_;
    const auto count = std::min<std::uint64_t>(counter(status, STATUS_BODY_PAIRS), pair_capacity);
    const auto first = self.build_.windowed ? status[STATUS_WINDOW_FIRST] : 0;
    const auto end =
        self.build_.windowed ? status[STATUS_WINDOW_END] : std::numeric_limits<std::uint32_t>::max();
    const auto& bodies = trees.bodies();
    const bool in_slots = bodies.pair_layout() == PairLayout::slots;
    trees.arena().execute([&] {
        tbb::parallel_for(std::uint64_t{0}, count, [&](std::uint64_t i) {
            const auto a = body_pairs[2 * i], b = body_pairs[2 * i + 1];
            PairTask task{
                self,  a,   b,        trees.boxes(a).data(), trees.boxes(b).data(), found, capacity, status,
                first, end, in_slots, bodies.first_slot(a),  bodies.first_slot(b)};
            if (trees.scene(a) && trees.scene(b))
                rtcCollide(trees.scene(a), trees.scene(b), self.leaf_test_, &task);
        });
    });
    trees.check();
}

void EmbreeWalker::do_launch(const WalkTask& task) {
    auto& device = trees_.bodies().device();
    const StageScope scope(device, Stage::traverse);
    const std::array<Argument, 6> arguments{task.body_pairs,
                                            task.pair_capacity,
                                            task.answer.pairs.buffer(),
                                            task.answer.pairs.capacity(),
                                            task.status.buffer(),
                                            self_};
    device.launch(kernel_, {1, 1}, arguments);
}

void EmbreeWalker::do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
    work[embree_counters::leaf_tests.name] += status.counter(status_leaf_tests);
}

} // namespace tandem
