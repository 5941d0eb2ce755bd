// SPDX-License-Identifier: MIT
#include "base/error.h"
#include "harness/sampling/turns.h"
#include "tests/support/test.h"

#include <fcntl.h>
#include <unistd.h>

namespace {

using namespace tandem;

/// Both pipes, as of `tandem compare --run`.
class TakenTurns : public testing::Test {
protected:
    void SetUp() override {
        ASSERT_EQ(pipe(goes_.data()), 0);
        ASSERT_EQ(pipe(asks_.data()), 0);
        set(fmt::format("{},{},18446744073709551615", goes_[0], asks_[1]));
    }
    void TearDown() override {
        unsetenv(Turns::variable);
        for (const auto descriptor : {goes_[0], goes_[1], asks_[0], asks_[1]}) close(descriptor);
    }
    static void set(const std::string& text) { setenv(Turns::variable, text.c_str(), 1); }
    void go() const { ASSERT_EQ(write(goes_[1], "g", 1), 1); }
    std::string asked() const {
        fcntl(asks_[0], F_SETFL, O_NONBLOCK);
        std::array<char, 8> text{};
        const auto length = read(asks_[0], text.data(), text.size());
        return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
    }

    std::array<int, 2> goes_{}, asks_{};
};

constexpr auto never = [] { return false; };

TEST_F(TakenTurns, AsksOnceForEachRound) {
    const auto turns = Turns::from_environment();
    ASSERT_TRUE(turns);
    EXPECT_TRUE(Turns::are_taken());
    EXPECT_EQ(turns->seed(), 18446744073709551615u);
    for (int round = 0; round < 2; ++round) {
        EXPECT_EQ(asked(), "");
        go();
        turns->wait(never);
        EXPECT_EQ(asked(), "r");
    }
}

TEST_F(TakenTurns, ASignalEndsTheWaiting) {
    int calls = 0;
    Turns::from_environment()->wait([&] { return ++calls == 3; });
    EXPECT_EQ(calls, 3);
}

TEST_F(TakenTurns, WithoutTheOtherEndNobodyWaits) {
    const auto turns = Turns::from_environment();
    close(goes_[1]);
    turns->wait(never);
    close(asks_[0]);
    turns->wait(never);
    goes_[1] = asks_[0] = -1;
}

TEST_F(TakenTurns, ProgramsThatItStartsInheritNoPipe) {
    EXPECT_EQ(fcntl(goes_[0], F_GETFD), 0);
    EXPECT_TRUE(Turns::from_environment());
    EXPECT_EQ(fcntl(goes_[0], F_GETFD), FD_CLOEXEC);
    EXPECT_EQ(fcntl(asks_[1], F_GETFD), FD_CLOEXEC);
}

TEST_F(TakenTurns, AMalformedVariableIsAnError) {
    for (const auto* text : {"", "3", "3,4", "3,4,x", "-1,-1,7"}) {
        set(text);
        EXPECT_THROW(Turns::from_environment(), InputError) << text;
    }
    set(fmt::format("{},{},7x", goes_[0], asks_[1]));
    EXPECT_THROW(Turns::from_environment(), InputError);
    unsetenv(Turns::variable);
    EXPECT_FALSE(Turns::from_environment());
    EXPECT_FALSE(Turns::are_taken());
}

} // namespace
