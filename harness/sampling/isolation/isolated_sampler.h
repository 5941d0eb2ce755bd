// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands/commands.h"
#include "harness/sampling/cell_sampler.h"

#include <span>

namespace tandem {

/// A cell of which the check and every round is done by another process: what a crash, an error that sticks
/// to the device, or a hang costs is this cell only. How such a process ended is a DeviceError.
class IsolatedSampler : public CellSampler {
public:
    /// `options` are those of the scene, its frames and the check; all must outlive this. The check and every
    /// round have a process of their own, whose luck is part of the noise.
    IsolatedSampler(const Cell& cell, const RunOptions& options, CellState state = {})
        : CellSampler(cell, std::move(state)), options_(options) {}

private:
    void do_check(const CheckOptions& options) override;
    void do_round(std::size_t samples) override;
    void do_count_work() override;
    void do_release() override {}

    void ask(const char* work, const CheckOptions& options, std::size_t samples);

    const RunOptions& options_;
};

/// Of rounds from number `first` on that another process took: this one has the GPU open as well, and leaves
/// it alone meanwhile, so that it is none of those that compute on it.
void leave_out_this_process(std::span<RoundConditions> rounds, std::uint32_t first);

/// What the process does: reads requests from standard input, a JSON object on each line, and writes the
/// answers to standard output, until there is no more. Returns the exit code.
int isolated_command();

} // namespace tandem
