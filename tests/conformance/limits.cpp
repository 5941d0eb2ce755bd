// SPDX-License-Identifier: MIT
// Kernels at body pairs past 2^31, where twice an index wraps in 32 bits. No scene has so many pairs: tables
// are mapped without memory behind them and have one nonzero row. A traversal gets one seed, or one item, of
// that pair. Host kernels compile from the same source as all others.
#include "algorithms/answer/status.h"
#include "algorithms/chunked/chunked.cl.h"
#include "algorithms/gproximity/gproximity.cl.h"
#include "algorithms/leaf_query/body_query.cl.h"
#include "algorithms/chunked/levels.clh"
#include "algorithms/gproximity/queues.clh"
#include "algorithms/kernels/sources.h"
#include "tests/support/cells.h"
#include "tests/support/flawed.h"
#include "tests/support/prepared_trees.h"
#include "tests/support/test.h"

#include <sys/mman.h>

namespace tandem {
namespace {

using namespace support;

constexpr std::uint32_t far_pair = 0x80000005; ///< twice this is 10 in 32 bits
constexpr std::uint32_t pair_count = 0x80000008;

/// Zeros of any size; only touched pages take memory.
class Zeros {
public:
    explicit Zeros(std::size_t bytes)
        : bytes_(bytes),
          memory_(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE,
                       -1, 0)) {
        if (memory_ == MAP_FAILED) throw std::bad_alloc();
    }
    ~Zeros() { munmap(memory_, bytes_); }
    Zeros(const Zeros&) = delete;
    Zeros& operator=(const Zeros&) = delete;

    std::uint32_t* words() const { return static_cast<std::uint32_t*>(memory_); }
    Buffer adopted(Device& device) const { return device.adopt(memory_, bytes_, "zeros"); }

private:
    std::size_t bytes_;
    void* memory_;
};

class Limits : public testing::Test {
protected:
    Limits() {
        on.update(scene.frame(0));
        pairs.words()[2 * std::size_t{far_pair}] = 0;
        pairs.words()[2 * std::size_t{far_pair} + 1] = 1;
        words[STATUS_BODY_PAIRS] = pair_count;
        auto two = scene;
        two.bodies.pop_back();
        auto frame = scene.frame(0);
        frame.poses.pop_back();
        frame.deformed.pop_back();
        expected = reference(two, frame, {}, false, Method::sweep).digest.count;
    }

    template<class Arguments>
    KernelOf<Arguments> compiled(Defines more = {}) {
        auto defines = on.trees.defines(1);
        defines.merge(more);
        KernelOf<Arguments> kernel;
        compile_kernel(host, kernel, defines);
        return kernel;
    }

    Buffer uploaded(std::span<const std::byte> bytes) {
        auto buffer = host.allocate(bytes.size(), "test");
        const StageScope scope(host, Stage::write);
        host.upload(buffer, bytes);
        return buffer;
    }

    template<class Arguments>
    std::uint32_t found_by(const KernelOf<Arguments>& kernel, const Arguments& arguments,
                           const Buffer& status) {
        const StageScope scope(host, Stage::traverse);
        host.launch(kernel, {1, 1}, arguments);
        host.download(status, std::as_writable_bytes(std::span(words)));
        return words[STATUS_PAIRS];
    }

    /// Traverses the far pair from one seed by either kernel of chunked.
    template<class Arguments>
    void traverse_far_pair() {
        words.assign(STATUS_WORDS, 0);
        words[STATUS_BODY_PAIRS] = pair_count;
        words[STATUS_LEVELS] = 1; // one seed from the previous level
        const auto status = uploaded(bytes_of(words));
        const auto seed = uploaded(bytes_of(std::vector<std::uint32_t>{far_pair, 0, 0}));
        const auto found = host.allocate(expected * 16, "found");
        const auto table = pairs.adopted(host);
        const auto seeds = starts.adopted(host);
        const Arguments arguments{.nodes = on.trees.nodes(),
                                  .trees = on.trees.tree_table(),
                                  .levels = on.trees.level_table(),
                                  .bodies = on.bodies.row_table(),
                                  .ids = on.bodies.ids(),
                                  .tetrahedra = on.bodies.tetrahedra(),
                                  .pairs = table,
                                  .pair_capacity = pair_count,
                                  .level = 0u,
                                  .seeds = seeds,
                                  .handed = seed,
                                  .handed_capacity = 1u,
                                  .below = seed,
                                  .below_capacity = 0u,
                                  .found = found,
                                  .capacity = static_cast<std::uint32_t>(expected),
                                  .status = status};
        EXPECT_EQ(found_by(compiled<Arguments>(), arguments, status), expected);
        std::vector<std::uint32_t> rows(expected * 4);
        const StageScope scope(host, Stage::read);
        host.download(found, std::as_writable_bytes(std::span(rows)));
        for (std::size_t i = 0; i < rows.size(); i += 4) {
            ASSERT_EQ(rows[i], 0u);
            ASSERT_EQ(rows[i + 1], 1u);
        }
    }

    Device& host = device("host");
    Scene scene = boxes_scene(3, 2);
    PreparedTrees on{host, scene, {}, 16384, 1}; ///< one chunk per body
    Zeros pairs{8 * std::size_t{pair_count}};
    Zeros starts{8 * (std::size_t{pair_count} + 1)};
    std::vector<std::uint32_t> words = std::vector<std::uint32_t>(STATUS_WORDS);
    std::uint64_t expected = 0;
};

TEST_F(Limits, ChunkedTraversesABodyPairPastHalfTheRange) {
    ASSERT_GT(expected, 100u);
    traverse_far_pair<kernels::chunked::Traverse>();
    traverse_far_pair<kernels::chunked::TraverseInGroups>();
}

TEST_F(Limits, QueuesTraverseABodyPairPastHalfTheRange) {
    const auto status = uploaded(bytes_of(words));
    constexpr std::uint32_t capacity = 100000;
    std::vector<std::uint32_t> items(3 * capacity);
    items[0] = far_pair;
    items[1] = items[2] = 1;
    const auto queue = uploaded(bytes_of(items));
    const auto counts = uploaded(bytes_of(std::vector<std::uint32_t>{1}));
    const auto idle = uploaded(bytes_of(std::vector<std::uint32_t>{0}));
    const auto found = host.allocate(expected * 16, "found");
    const auto table = pairs.adopted(host);
    const kernels::gproximity::TraverseQueues arguments{.nodes = on.trees.nodes(),
                                                        .trees = on.trees.tree_table(),
                                                        .bodies = on.bodies.row_table(),
                                                        .ids = on.bodies.ids(),
                                                        .tetrahedra = on.bodies.tetrahedra(),
                                                        .pairs = table,
                                                        .items = queue,
                                                        .counts = counts,
                                                        .queue_capacity = capacity,
                                                        .idle = idle,
                                                        .found = found,
                                                        .capacity = static_cast<std::uint32_t>(expected),
                                                        .status = status};
    const Defines defines{{"LOCAL_QUEUE", "50000"}, {"REFILL", "1"}, {"FULL_EXIT", "0"}, {"IDLE_LIMIT", "9"}};
    EXPECT_EQ(found_by(compiled<kernels::gproximity::TraverseQueues>(defines), arguments, status), expected);
}

/// A queue with more node pairs than it has rows, which the host's balance never makes.
TEST_F(Limits, AQueueBeyondItsCapacityIsReported) {
    const auto status = uploaded(bytes_of(words));
    const std::vector<std::uint32_t> items(3 * 4);
    const auto queue = uploaded(bytes_of(items));
    const auto idle = uploaded(bytes_of(std::vector<std::uint32_t>{0}));
    const auto found = host.allocate(expected * 16, "found");
    const auto table = pairs.adopted(host);
    const Defines defines{{"LOCAL_QUEUE", "4"}, {"IDLE_LIMIT", "1"}};
    const auto kernel = compiled<kernels::gproximity::TraverseQueues>(defines);
    for (const std::uint32_t stored : {4u, 5u}) {
        const auto counts = uploaded(bytes_of(std::vector<std::uint32_t>{stored}));
        const kernels::gproximity::TraverseQueues arguments{.nodes = on.trees.nodes(),
                                                            .trees = on.trees.tree_table(),
                                                            .bodies = on.bodies.row_table(),
                                                            .ids = on.bodies.ids(),
                                                            .tetrahedra = on.bodies.tetrahedra(),
                                                            .pairs = table,
                                                            .items = queue,
                                                            .counts = counts,
                                                            .queue_capacity = 4u,
                                                            .idle = idle,
                                                            .found = found,
                                                            .capacity = static_cast<std::uint32_t>(expected),
                                                            .status = status};
        found_by(kernel, arguments, status);
        EXPECT_EQ(words[STATUS_EXCEEDED + EXCEEDED_QUEUE], stored > 4 ? 1u : 0u);
    }
}

/// Fewer blocks of queries than a body pair needs, which the host's count of queries never gives.
TEST_F(Limits, QueriesBeyondTheirBlocksAreReported) {
    const auto found = host.allocate(expected * 16, "found");
    const std::vector<std::uint32_t> pair{0, 1};
    const auto table = uploaded(bytes_of(pair));
    const auto kernel = compiled<kernels::body_query::QueryLeaves>();
    const auto needed = on.bodies.row(0).tetrahedron_count;
    for (const std::uint32_t blocks : {needed, needed - 1}) {
        words.assign(STATUS_WORDS, 0);
        words[STATUS_BODY_PAIRS] = 1;
        const auto status = uploaded(bytes_of(words));
        const kernels::body_query::QueryLeaves arguments{.nodes = on.trees.nodes(),
                                                         .trees = on.trees.tree_table(),
                                                         .bodies = on.bodies.row_table(),
                                                         .ids = on.bodies.ids(),
                                                         .tetrahedra = on.bodies.tetrahedra(),
                                                         .pairs = table,
                                                         .pair_capacity = 1u,
                                                         .blocks = blocks,
                                                         .found = found,
                                                         .capacity = static_cast<std::uint32_t>(expected),
                                                         .status = status};
        const auto count = found_by(kernel, arguments, status);
        EXPECT_EQ(count == expected, blocks == needed);
        EXPECT_EQ(words[STATUS_EXCEEDED + EXCEEDED_QUERIES], blocks == needed ? 0u : 1u);
    }
}

TEST_F(Limits, AFrameThatExceedsABoundFails) {
    Status status(host, Status::Writes::queued);
    status.begin(0);
    EXPECT_NO_THROW(status.read());
    for (std::size_t bound = 0; bound < EXCEEDED_WORDS; ++bound) {
        auto exceeded = status.words();
        exceeded[STATUS_EXCEEDED + bound] = 1;
        status.write(exceeded);
        if (bound == EXCEEDED_UNITS) // by the input
            EXPECT_THROW(status.read(), InputError);
        else
            EXPECT_THROW(status.read(), DeviceError) << bound;
        status.begin(0);
    }
}

} // namespace
} // namespace tandem
