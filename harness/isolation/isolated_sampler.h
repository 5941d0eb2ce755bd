// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands.h"
#include "harness/isolation/child_process.h"
#include "harness/sampling/cell_sampler.h"

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>

namespace tandem {

/// `tandem isolated`: a process that answers requests, until one of them fails it or its device. The next
/// request then has another.
class AnsweringProcess {
public:
    /// Throws DeviceError where it ended without an answer, InputError where the request was wrong, and
    /// GivenUp.
    nlohmann::json ask(const nlohmann::json& request, const ChildLimits& limits);

private:
    std::unique_ptr<ChildProcess> child_;
};

/// A cell of which the check and every round is done by another process: what a crash, an error that sticks
/// to the device, or a hang costs is this cell only. How such a process ended is a DeviceError.
class IsolatedSampler : public CellSampler {
public:
    /// `options` are those of the scene, its frames and the check; all must outlive this.
    /// Work that nobody waits for, as `give_up` says, throws GivenUp. `process` is asked; null: one of its
    /// own for the check and for every round, whose luck is part of the noise then.
    IsolatedSampler(const Cell& cell, const RunOptions& options, CellState state = {},
                    std::function<bool()> give_up = {}, AnsweringProcess* process = nullptr)
        : CellSampler(cell, std::move(state)),
          options_(options),
          give_up_(std::move(give_up)),
          process_(process) {}

private:
    void do_check(const CheckOptions& options) override;
    void do_round(std::size_t samples) override;
    void do_count_work() override;
    void do_release() override {}

    void ask(const char* work, const CheckOptions& options, std::size_t samples);

    const RunOptions& options_;
    std::function<bool()> give_up_;
    AnsweringProcess* process_;
};

/// Of rounds from number `first` on that another process took: this one has the GPU open as well, and leaves
/// it alone meanwhile, so that it is none of those that compute on it.
void leave_out_this_process(std::span<RoundConditions> rounds, std::uint32_t first);

/// What the process does: reads what is asked for from standard input, an object of JSON on each line, and
/// writes the answers to standard output, until there is no more. Devices stay open. Returns the exit code.
int isolated_command();

} // namespace tandem
