// SPDX-License-Identifier: MIT
#include "backends/staging.h"

#include <gtest/gtest.h>
#include <map>

namespace tandem {
namespace {

constexpr std::size_t MiB = std::size_t{1} << 20;

/// Memory that counts its allocated blocks.
struct Source {
    std::map<std::byte*, std::size_t> blocks;
    bool empty = false; ///< allocations fail

    Staging::Source source() {
        return {[this](std::size_t bytes) -> std::byte* {
                    if (empty) return nullptr;
                    auto* memory = new std::byte[bytes];
                    blocks[memory] = bytes;
                    return memory;
                },
                [this](std::byte* memory) {
                    EXPECT_EQ(blocks.erase(memory), 1u);
                    delete[] memory;
                }};
    }
    std::size_t bytes_in_use() const {
        std::size_t sum = 0;
        for (const auto& [memory, bytes] : blocks) sum += bytes;
        return sum;
    }
};

TEST(DeviceStaging, IsBoundedAndReused) {
    Source source;
    {
        Staging staging(source.source(), 10 * MiB);
        for (int round = 0; round < 100; ++round) {
            std::size_t taken = 0;
            std::map<std::byte*, std::size_t> parts;
            while (auto* part = staging.take(MiB / 2 + 1)) {
                const auto [position, is_new] = parts.emplace(part, MiB / 2 + 1);
                ASSERT_TRUE(is_new);
                if (position != parts.begin()) {
                    EXPECT_LE(std::prev(position)->first + std::prev(position)->second, part);
                }
                ++taken;
            }
            EXPECT_EQ(taken, 14u); // seven in each of two blocks of 4 MiB
            EXPECT_EQ(source.bytes_in_use(), 8 * MiB);
            EXPECT_NE(staging.take(1), nullptr); // fits into their rest
            staging.release();
        }
    }
    EXPECT_EQ(source.bytes_in_use(), 0u);
}

TEST(DeviceStaging, ALargeBlockReplacesSmallOnes) {
    Source source;
    Staging staging(source.source(), 10 * MiB);
    EXPECT_NE(staging.take(3 * MiB), nullptr);
    EXPECT_NE(staging.take(3 * MiB), nullptr);
    EXPECT_EQ(staging.take(9 * MiB), nullptr) << "the blocks are in flight";
    staging.release();
    EXPECT_NE(staging.take(10 * MiB), nullptr);
    EXPECT_EQ(source.bytes_in_use(), 10 * MiB);
    EXPECT_EQ(staging.take(1), nullptr);
    staging.release();
    EXPECT_EQ(staging.take(10 * MiB + 1), nullptr) << "more than the limit";
    EXPECT_NE(staging.take(1), nullptr);
}

TEST(DeviceStaging, ASystemWithoutMemoryIsNoError) {
    Source source;
    Staging staging(source.source(), 100);
    EXPECT_EQ(staging.take(101), nullptr);
    EXPECT_EQ(staging.take(100), nullptr) << "rounded up, it exceeds the limit";
    Staging larger(source.source(), MiB);
    source.empty = true;
    EXPECT_EQ(larger.take(100), nullptr);
    source.empty = false;
    EXPECT_NE(larger.take(100), nullptr);
    EXPECT_EQ(source.bytes_in_use(), MiB) << "a block is no larger than the limit";
}

} // namespace
} // namespace tandem
