// SPDX-License-Identifier: MIT
// The radix sort of a device against a stable sort of the host.
#include "algorithms/hierarchy/radix_sort.h"
#include "backends/upload.h"
#include "base/random.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

/// Rows of words, keys before values.
using Columns = std::array<std::vector<std::uint32_t>, 2>;

class RadixSorts : public OnDevice {
protected:
    /// The columns after a launch whose flag has the value `flag`.
    Columns sorted(std::uint32_t group_size, std::uint32_t groups, Columns columns, std::uint32_t flag) {
        const auto count = static_cast<std::uint32_t>(columns[0].size());
        const RadixSort sort(on, {group_size, groups}, count);
        const auto flags = uploaded(on, bytes_of(std::vector{flag}), "flag");
        const StageScope scope(on, Stage::refit);
        on.upload(sort.keys(), bytes_of(columns[0]));
        on.upload(sort.values(), bytes_of(columns[1]));
        sort.launch(count, flags);
        on.download(sort.keys(), std::as_writable_bytes(std::span(columns[0])));
        on.download(sort.values(), std::as_writable_bytes(std::span(columns[1])));
        return columns;
    }
};

Columns stably_sorted(const Columns& columns) {
    std::vector<std::uint32_t> order(columns[0].size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return columns[0][i]; });
    Columns right;
    for (const auto i : order)
        for (std::size_t column = 0; column < 2; ++column) right[column].push_back(columns[column][i]);
    return right;
}

/// Keys of all 32 bits, of few values, and of one value; rows for less than a turn and for many groups.
TEST_P(RadixSorts, EqualAStableSort) {
    Random random(3);
    const auto group_sizes = on.info().max_group_size == 1 ? std::vector{1u} : std::vector{1u, 32u, 128u};
    for (const auto group_size : group_sizes)
        for (const std::uint32_t rows : {1u, 2u, 127u, 1025u, 9001u})
            for (const std::uint32_t values : {0u, 300u, 1u}) {
                SCOPED_TRACE(fmt::format("groups of {}, {} rows, {} values", group_size, rows, values));
                Columns columns;
                for (std::uint32_t i = 0; i < rows; ++i) {
                    const auto key = static_cast<std::uint32_t>(random.next());
                    columns[0].push_back(values == 0 ? key : key % values << 20);
                    columns[1].push_back(i);
                }
                EXPECT_EQ(sorted(group_size, 64, columns, 1), stably_sorted(columns));
            }
}

/// A single group sorts all rows, so that the number of groups does not matter.
TEST_P(RadixSorts, NeedNoMoreThanOneGroup) {
    Columns columns;
    for (std::uint32_t i = 0; i < 5000; ++i) {
        columns[0].push_back(i * 2654435761u);
        columns[1].push_back(i);
    }
    EXPECT_EQ(sorted(on.info().max_group_size == 1 ? 1 : 64, 1, columns, 7), stably_sorted(columns));
}

/// The launches end at once where the flag is 0; four passes would end in the first buffers.
TEST_P(RadixSorts, DoNothingWithoutTheFlag) {
    const Columns columns{std::vector<std::uint32_t>{3, 1, 2}, std::vector<std::uint32_t>{0, 1, 2}};
    EXPECT_EQ(sorted(1, 4, columns, 0), columns);
    EXPECT_NE(sorted(1, 4, columns, 1), columns);
}

TANDEM_ON_DEVICES(RadixSorts);

} // namespace
} // namespace tandem
