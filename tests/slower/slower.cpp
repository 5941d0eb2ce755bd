// SPDX-License-Identifier: MIT
// Makes every frame of the program take 5 % longer, so that tests of comparisons have a real change to find.
// The linker replaces Session::run_among by the function below (--wrap in tests/CMakeLists.txt).
#include "algorithms/traversal.h"

#include <chrono>

#define RUN_AMONG                                                                                            \
    "_ZN6tandem7Session9run_amongERKNS_10FrameInputESt8optionalISt4spanIKNS_"                                \
    "8BodyPairELm18446744073709551615EEE"

namespace {

using BodyPairs = std::optional<std::span<const tandem::BodyPair>>;
constexpr int parts = 20; // one part longer

} // namespace

// Member functions have the calling convention of functions whose first parameter is `this` (Itanium C++
// ABI).
tandem::FrameResult run_among(tandem::Session* session, const tandem::FrameInput& input,
                              BodyPairs body_pairs) asm("__real_" RUN_AMONG);
tandem::FrameResult run_longer(tandem::Session* session, const tandem::FrameInput& input,
                               BodyPairs body_pairs) asm("__wrap_" RUN_AMONG);

tandem::FrameResult run_longer(tandem::Session* session, const tandem::FrameInput& input,
                               BodyPairs body_pairs) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    auto result = run_among(session, input, body_pairs);
    const auto end = Clock::now() + (Clock::now() - start) / parts;
    while (Clock::now() < end) {}
    return result;
}
