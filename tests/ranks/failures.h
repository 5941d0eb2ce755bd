// SPDX-License-Identifier: MIT
#pragma once

#include "tests/support/test.h"

#include <cstdio>

namespace tandem {

/// Prints failures only, with the rank.
class FailuresOfARank : public testing::EmptyTestEventListener {
public:
    explicit FailuresOfARank(std::size_t rank) : rank_(rank) {}

    void OnTestStart(const testing::TestInfo& test) override { test_ = test.name(); }
    void OnTestEnd(const testing::TestInfo&) override { test_.clear(); }
    /// Google Test holds its lock here, so that asking it for the current test would block.
    void OnTestPartResult(const testing::TestPartResult& result) override {
        if (!result.failed()) return;
        const auto* file = result.file_name();
        fmt::print(stderr, "rank {}: {}: {}:{}: {}\n", rank_, test_, file != nullptr ? file : "",
                   result.line_number(), result.message());
    }

private:
    std::size_t rank_;
    std::string test_; ///< the name of the running test
};

} // namespace tandem
