// SPDX-License-Identifier: MIT
// Numbers past 32 bits, for which no scene is large enough: the sum of gProximity's queues, and explicit body
// pairs.
#include "algorithms/gproximity/balance.cl.h"
#include "algorithms/gproximity/queues.clh"
#include "algorithms/kernels/sources.h"
#include "tests/support/on_device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

class Queues : public OnDevice {
protected:
    /// Plans queues that contain `counts` with a work-group of `group_size`. Returns {items, whether to
    /// balance}; `starts` receives the prefix sums and the total. Queues below 2 items request balancing.
    std::array<std::uint32_t, 2> plan(std::uint32_t group_size, const std::vector<std::uint32_t>& counts,
                                      std::vector<std::uint32_t>& starts) {
        const StageScope scope(on, Stage::balance);
        const auto queues = static_cast<std::uint32_t>(counts.size());
        KernelOf<kernels::balance::PlanBalance> kernel;
        compile_kernel(on, kernel, {{"PRECISION", "32"}, {"GROUP_SIZE", std::to_string(group_size)}});
        const auto counts_on = on.allocate(queues * 4, "counts");
        const auto starts_on = on.allocate((queues + 1) * 4, "starts");
        const auto totals_on = on.allocate(8, "totals");
        on.upload(counts_on, bytes_of(counts));
        on.launch(kernel, {1, group_size},
                  {.counts = counts_on,
                   .queues = queues,
                   .low = 2u,
                   .high = 0xffffffffu,
                   .starts = starts_on,
                   .totals = totals_on});
        std::array<std::uint32_t, 2> totals{};
        on.download(totals_on, std::as_writable_bytes(std::span(totals)));
        starts.resize(queues + 1);
        on.download(starts_on, std::as_writable_bytes(std::span(starts)));
        return totals;
    }

    std::vector<std::uint32_t> group_sizes() const {
        return on.info().max_group_size == 1 ? std::vector<std::uint32_t>{1}
                                             : std::vector<std::uint32_t>{1, 2, 32};
    }
};

using Totals = std::array<std::uint32_t, 2>;
using Starts = std::vector<std::uint32_t>;

TEST_P(Queues, AreSummed) {
    for (const auto group_size : group_sizes()) {
        Starts starts;
        EXPECT_EQ(plan(group_size, {3, 0, 5, 2, 9}, starts), (Totals{19, 1}));
        EXPECT_EQ(starts, (Starts{0, 3, 3, 8, 10, 19}));
        EXPECT_EQ(plan(group_size, {3, 4, 5}, starts), (Totals{12, 0}));
        EXPECT_EQ(plan(group_size, {0, 0, 0}, starts), (Totals{0, 0}));
    }
}

/// One below the limit, exactly the limit, and sums that are 0, 4 and 2^31 + 4 modulo 2^32.
TEST_P(Queues, SumsSaturateAtTheLargestCount) {
    const auto most = MOST_QUEUE_ITEMS;
    for (const auto group_size : group_sizes()) {
        Starts starts;
        EXPECT_EQ(plan(group_size, {most - 8, 7, 0}, starts), (Totals{most - 1, 1}));
        EXPECT_EQ(starts, (Starts{0, most - 8, most - 1, most - 1}));
        for (const auto& counts : {Starts{most - 8, 8, 0}, Starts{0, most, most}, Starts{most, 0, most, 4},
                                   Starts{1, most, most, most, 3}})
            EXPECT_EQ(plan(group_size, counts, starts), (Totals{most, 0})) << counts.size();
    }
}

TEST_P(Queues, TooManyBodyPairsAreRejected) {
    const auto scene = crowd(3, 2, 0.5);
    const BodyPair pair{0, 1};
    for (const auto* traversal : algorithms()) {
        const auto session = prepare_on(on, *traversal, scene, {{"broad", "sphere"}});
        // Rejected before the first pair is read.
        EXPECT_THROW(session->run(scene.frame(0), {&pair, std::size_t{1} << 32}), InputError);
        EXPECT_GT(session->run(scene.frame(0), {&pair, 1}).count, 0u);
    }
}

TANDEM_ON_DEVICES(Queues);

} // namespace
} // namespace tandem
