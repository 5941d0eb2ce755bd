// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands.h"
#include "harness/sampling/cell_sampler.h"

namespace tandem {

/// A cell of which the check and every round is done by a process of its own: what a crash, an error that
/// sticks to the device, or a hang costs is this cell only, and the luck of a process is part of the noise
/// of its rounds. How such a process ended is a DeviceError.
class IsolatedSampler : public CellSampler {
public:
    /// `options` are those of the scene, its frames and the check; both must outlive this.
    IsolatedSampler(const Cell& cell, const RunOptions& options, CellState state = {})
        : CellSampler(cell, std::move(state)), options_(options) {}

private:
    void do_check(const CheckOptions& options) override;
    void do_round(std::size_t samples) override;
    void do_count_work() override;
    void do_release() override {}

    void ask(const char* work, const CheckOptions& options, std::size_t samples);
    void leave_out_this_process(std::uint32_t first);

    const RunOptions& options_;
};

/// What the process does: reads what is asked for from standard input and writes the answer to standard
/// output, both a JSON object. Returns the exit code.
int isolated_command();

} // namespace tandem
