// SPDX-License-Identifier: MIT
// Counts of a frame, which its parts add up and other processes get.
#include "harness/sampling/cell_state.h"
#include "tests/support/cells.h"
#include "tests/support/test.h"

#include <bit>
#include <nlohmann/json.hpp>

namespace tandem {
namespace {

using Values = std::array<std::uint64_t, sizeof(FrameCounts) / sizeof(std::uint64_t)>;

FrameCounts all_different() {
    Values values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = i + 1;
    return std::bit_cast<FrameCounts>(values);
}

TEST(FrameCounts, EveryMemberIsAdded) {
    FrameCounts sum;
    for (int times = 0; times < 3; ++times) sum += all_different();
    const auto sums = std::bit_cast<Values>(sum);
    for (std::size_t i = 0; i < sums.size(); ++i) EXPECT_EQ(sums[i], 3 * (i + 1)) << "member " << i;
}

TEST(FrameCounts, AnotherProcessGetsEveryMember) {
    const auto& chunked = algorithm("chunked");
    const auto cell = make_cell(chunked, chunked.presets().front(), {}, {&support::device("host")});
    CellState state, other;
    state.measurement.settings = cell.settings;
    state.measurement.counts = all_different();
    take_checked(other, checked_json(state), cell);
    EXPECT_EQ(std::bit_cast<Values>(other.measurement.counts), std::bit_cast<Values>(all_different()));
}

} // namespace
} // namespace tandem
