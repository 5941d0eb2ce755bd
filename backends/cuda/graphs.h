// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/command.h"

#include <span>
#include <vector>

namespace tandem::cuda {

/// Sequences of commands that go to the driver as one, once they have come before: a graph is captured when
/// the same commands, with the same arguments, come a second time. What never comes again costs no graph.
class Graphs {
public:
    /// What the driver refused.
    struct Failure {
        Result code = 0; ///< 0: nothing
        std::string_view call;
        std::string what; ///< made of failures only
    };

    /// So many sequences are remembered: a frame with every set of buffers that answers lie in, twice over.
    static constexpr std::size_t most = 16;

    /// `driver` has to outlive it. Before it dies drop() has to have been called.
    explicit Graphs(const Driver& driver) : driver_(driver) {}

    /// Enqueues commands on a stream that can be captured, which the default stream cannot. `submissions`
    /// becomes larger by the number of calls that hand work over.
    Failure submit(std::span<const Command> commands, Stream stream, std::uint64_t& submissions);
    /// Forgets everything and destroys all graphs, none of which is running. Memory that commands name must
    /// not be freed, or stop being what it was, without this.
    void drop();

private:
    struct Known {
        std::vector<Command> commands;
        GraphExec graph = nullptr; ///< none yet: seen once
        std::uint64_t used = 0;    ///< when, in submissions of sequences
    };

    Known* find(std::span<const Command> commands);
    Failure remember(std::span<const Command> commands, Stream stream);
    Failure capture(Known& known, Stream stream);

    const Driver& driver_;
    std::vector<Known> known_;
    std::uint64_t now_ = 0;
};

} // namespace tandem::cuda
