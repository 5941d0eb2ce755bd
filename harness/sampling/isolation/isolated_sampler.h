// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/run_options.h"
#include "harness/sampling/cell_sampler.h"

#include <span>

namespace tandem {

/// Measures a cell in child processes, one for the check and one for each round. A crash, a hang or a
/// persistent device error affects only this cell. Throws DeviceError when a child ends without an answer.
class IsolatedSampler : public CellSampler {
public:
    /// `options` select the scene, its frames and the check. `cell` and `options` must outlive this object.
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

/// Subtracts this process from the GPU processes in the conditions of rounds from `first` on. A child process
/// measured them, and this process had the GPU open but idle.
void leave_out_this_process(std::span<RoundConditions> rounds, std::uint32_t first);

/// The main function of a child process. Reads requests from standard input, one JSON object a line, and
/// writes answers to standard output until the input ends. Returns the exit code.
int isolated_command();

} // namespace tandem
