// SPDX-License-Identifier: MIT
#include "algorithms/answer/growable_buffer.h"
#include "backends/registry.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

constexpr std::size_t id_bytes = 16, value_bytes = 32, row_bytes = id_bytes + value_bytes;

/// Rows of two columns on a separate host device.
class GrowableRows : public testing::Test {
protected:
    void allow(std::size_t bytes) { on->set_memory_limit(on->bytes_allocated() + bytes); }

    void expect_column_capacity(std::uint64_t rows) const {
        EXPECT_EQ(buffer.capacity(), rows);
        EXPECT_EQ(buffer.buffer(0).bytes(), rows * id_bytes);
        EXPECT_EQ(buffer.buffer(1).bytes(), rows * value_bytes);
        EXPECT_EQ(on->bytes_allocated(), rows * row_bytes);
    }

    std::unique_ptr<Device> on = std::move(discover().front().devices.front());
    GrowableBuffer buffer{*on, {{"ids", id_bytes}, {"values", value_bytes}}, 80};
};

TEST_F(GrowableRows, GrowByAnExtraEighthInAllColumns) {
    EXPECT_EQ(buffer.row_bytes(), row_bytes);
    expect_column_capacity(80);
    buffer.grow(160);
    expect_column_capacity(180);
    buffer.reserve(100);
    expect_column_capacity(180);
    buffer.reserve(181);
    expect_column_capacity(181);
}

/// Memory suffices for the spare rows of one column but not of the other: then neither column has them.
TEST_F(GrowableRows, HaveOneCapacityUnderEveryLimit) {
    for (std::uint64_t limit = 0; limit <= 200 * row_bytes; limit += 4) {
        on->set_memory_limit(limit);
        const auto before = buffer.capacity();
        try {
            buffer.grow(160);
            EXPECT_GE(limit, 160 * row_bytes);
            expect_column_capacity(limit >= 180 * row_bytes ? 180 : 160);
        } catch (const OutOfMemory&) {
            EXPECT_LT(limit, 160 * row_bytes);
            if (buffer.capacity() > 0) expect_column_capacity(buffer.capacity());
            EXPECT_LE(buffer.capacity(), before);
        }
        on->set_memory_limit(Device::no_memory_limit);
        if (buffer.capacity() == 0) buffer.reserve(1); // a buffer without memory can be used again
    }
}

TEST_F(GrowableRows, KeepTheirCapacityWhenTheyCannotGrow) {
    allow(10 * row_bytes);
    EXPECT_THROW(buffer.grow(160), OutOfMemory);
    expect_column_capacity(80);
    on->set_memory_limit(30 * row_bytes); // less than they have: the capacity halves twice
    EXPECT_THROW(buffer.grow(160), OutOfMemory);
    expect_column_capacity(20);
    on->set_memory_limit(0);
    EXPECT_THROW(buffer.reserve(21), OutOfMemory);
    EXPECT_EQ(buffer.capacity(), 0u);
    EXPECT_THROW(buffer.buffer(1), OutOfMemory);
    EXPECT_THROW(buffer.grow(GrowableBuffer::most + 1), OutOfMemory);
}

} // namespace
} // namespace tandem
