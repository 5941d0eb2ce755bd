// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/command.h"

#include <span>
#include <vector>

namespace tandem::cuda {

/// Submits repeated sequences of commands as one. A graph is captured when the same commands, with the same
/// arguments, come a second time. A sequence that never repeats needs no graph.
class Graphs {
public:
    /// An error of the driver.
    struct Failure {
        Result code = 0; ///< 0: none
        std::string_view call;
        std::string what; ///< set on failure only
    };

    /// Sequences that are remembered: a frame with each set of buffers that results use, twice over.
    static constexpr std::size_t max_sequences = 16;

    /// `driver` must outlive it. Call drop() before it is destroyed.
    explicit Graphs(const Driver& driver) : driver_(driver) {}

    /// Enqueues commands on a stream that can be captured; the default stream cannot. Adds the number of
    /// calls that submit work to `submissions`.
    Failure submit(std::span<const Command> commands, Stream stream, std::uint64_t& submissions);
    /// Forgets all sequences and destroys their graphs; none may be running. Required before memory that
    /// commands use is freed or reused.
    void drop();

private:
    struct Known {
        std::vector<Command> commands;
        GraphExec graph = nullptr; ///< null until the sequence repeats
        std::uint64_t used = 0;    ///< time of the last use, in submissions
    };

    Known* find(std::span<const Command> commands);
    Failure remember(std::span<const Command> commands, Stream stream);
    Failure capture(Known& known, Stream stream);

    const Driver& driver_;
    std::vector<Known> known_;
    std::uint64_t now_ = 0;
};

} // namespace tandem::cuda
