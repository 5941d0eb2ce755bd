// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>

namespace tandem {

/// Prints failures only, with the rank.
class FailuresOfARank : public testing::EmptyTestEventListener {
public:
    explicit FailuresOfARank(std::size_t rank) : rank_(rank) {}

    void OnTestPartResult(const testing::TestPartResult& result) override {
        if (!result.failed()) return;
        const auto* file = result.file_name();
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        fmt::print(stderr, "rank {}: {}: {}:{}: {}\n", rank_, test != nullptr ? test->name() : "",
                   file != nullptr ? file : "", result.line_number(), result.message());
    }

private:
    std::size_t rank_;
};

} // namespace tandem
