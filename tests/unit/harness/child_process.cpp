// SPDX-License-Identifier: MIT
// A child process that answers line by line: its other output, its end, and limits.
#include "harness/sampling/isolation/child_process.h"
#include "tests/support/test.h"

#include <iostream>
#include <thread>

namespace tandem {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

constexpr const char* is_child = "TANDEM_TEST_IS_CHILD";

/// Main loop of this program as a child process, in place of the tests.
[[maybe_unused]] const bool answered = [] {
    if (std::getenv(is_child) == nullptr) return false;
    for (std::string line; std::getline(std::cin, line);) {
        if (line == "crash") std::abort();
        if (line == "leave") std::_Exit(7);
        if (line == "hang") std::this_thread::sleep_for(std::chrono::hours(1));
        std::cout << "before\n<" << line << ">" << end_of_answer << "behind\n" << std::flush;
    }
    std::_Exit(0);
}();

class ChildProcesses : public testing::Test {
protected:
    static void SetUpTestSuite() { setenv(is_child, "1", 1); }
    static void TearDownTestSuite() { unsetenv(is_child); }
    ChildResult ask(const char* line, double seconds = 60) { return child.ask(line, seconds); }

    ChildProcess child{std::array<std::string, 1>{"child"}};
};

TEST_F(ChildProcesses, AnswerLineByLine) {
    const std::string much(1 << 20, 'x');
    for (const auto& line : {std::string("one"), std::string("two"), much, std::string()}) {
        const auto result = ask(line.c_str());
        EXPECT_EQ(result.failure, "");
        EXPECT_THAT(result.output, EndsWith("before\n<" + line + ">"));
        EXPECT_FALSE(child.has_ended());
    }
}

TEST_F(ChildProcesses, ReportTheirExitCode) {
    EXPECT_EQ(ask("leave").failure, "ended with code 7");
    EXPECT_TRUE(child.has_ended());
}

TEST_F(ChildProcesses, ReportTheirSignal) {
    ask("one");
    EXPECT_THAT(ask("crash").failure, HasSubstr("ended by signal 6"));
    EXPECT_TRUE(child.has_ended());
}

TEST_F(ChildProcesses, AreKilledAfterTheTimeout) {
    EXPECT_EQ(ask("hang", 0.2).failure, "took longer than 0.2 s and was ended");
    EXPECT_TRUE(child.has_ended());
}

} // namespace
} // namespace tandem
