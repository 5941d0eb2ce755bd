// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

namespace tandem {

/// Rounds by turns with another process, so that drift of the machine affects both alike. `tandem compare
/// --run` (python/tandem/comparison/turns.py) starts both processes and decides which of them goes on. It
/// passes two file descriptors of pipes, from which and to which this process reads and writes one byte for
/// each round.
class Turns {
public:
    /// The name of the environment variable "READ,WRITE,SEED": both descriptors and the seed of the order of
    /// cells, which is the same in both processes.
    static constexpr const char* variable = "TANDEM_TURNS";

    /// Whether this process, or the one that started it, takes turns.
    static bool are_taken();
    /// Turns as the environment says; none without the variable. Throws InputError if it is malformed.
    static std::optional<Turns> from_environment();

    std::uint64_t seed() const { return seed_; }
    /// Waits for this process's turn before each round; conditions leave out the time. Returns early when
    /// `stop` returns true, and at once when the other end has closed its pipes.
    void wait(const std::function<bool()>& stop) const;

private:
    void wait_for_turn(const std::function<bool()>& stop) const;

    Turns(int from, int to, std::uint64_t seed) : from_(from), to_(to), seed_(seed) {}

    int from_, to_;
    std::uint64_t seed_;
};

} // namespace tandem
