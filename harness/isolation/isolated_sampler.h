// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands.h"
#include "harness/isolation/child_process.h"
#include "harness/sampling/cell_sampler.h"

#include <nlohmann/json_fwd.hpp>
#include <span>

namespace tandem {

/// A cell of which the check and every round is done by a process of its own: what a crash, an error that
/// sticks to the device, or a hang costs is this cell only, and the luck of a process is part of the noise
/// of its rounds. How such a process ended is a DeviceError.
class IsolatedSampler : public CellSampler {
public:
    /// `options` are those of the scene, its frames and the check; both must outlive this.
    /// Work that nobody waits for, as `give_up` says, throws GivenUp.
    IsolatedSampler(const Cell& cell, const RunOptions& options, CellState state = {},
                    std::function<bool()> give_up = {})
        : CellSampler(cell, std::move(state)), options_(options), give_up_(std::move(give_up)) {}

private:
    void do_check(const CheckOptions& options) override;
    void do_round(std::size_t samples) override;
    void do_count_work() override;
    void do_release() override {}

    void ask(const char* work, const CheckOptions& options, std::size_t samples);

    const RunOptions& options_;
    std::function<bool()> give_up_;
};

/// What `tandem isolated` answers to a request. Throws DeviceError where it ended without an answer,
/// InputError where the request was wrong, and GivenUp.
nlohmann::json ask_isolated(const nlohmann::json& request, const ChildLimits& limits);

/// Of rounds from number `first` on that another process took: this one has the GPU open as well, and leaves
/// it alone meanwhile, so that it is none of those that compute on it.
void leave_out_this_process(std::span<RoundConditions> rounds, std::uint32_t first);

/// What the process does: reads what is asked for from standard input and writes the answer to standard
/// output, both a JSON object. Returns the exit code.
int isolated_command();

} // namespace tandem
