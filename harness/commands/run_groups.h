// SPDX-License-Identifier: MIT
#pragma once

#include "backends/registry.h"
#include "harness/plans/cell_groups.h"
#include "harness/plans/task.h"

#include <memory>

namespace tandem {

/// The groups of cells of a run, with their open devices. Under MPI, every rank has the same groups; their
/// cells are on its own device.
class RunGroups {
public:
    /// Opens the devices and forms the groups. Prints which cells are left out, and why. `options` and `team`
    /// must outlive this; a null team is one process. Throws InputError.
    RunGroups(const RunOptions& options, RankTeam* team);

    const std::vector<CellGroup>& groups() const { return all_.groups; }
    /// Opens the scene and the frames of a group. Cells that do not fit them go to `unfit` if the plan skips
    /// such cells. Throws InputError.
    std::unique_ptr<Task> open(const CellGroup& group, const Unfit& unfit) const;

private:
    void check_one_group() const;
    void open_team();

    const RunOptions& options_;
    RankTeam* const team_;
    std::vector<BackendReport> backends_; ///< own the devices of the cells
    CellGroups all_;
};

/// Prints on standard error that a cell is skipped.
void print_skipped(const InputError& error);

} // namespace tandem
