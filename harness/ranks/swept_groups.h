// SPDX-License-Identifier: MIT
#pragma once

#include "harness/finished_cells.h"
#include "harness/plans/cell_groups.h"
#include "harness/ranks/hands.h"
#include "harness/run_parts.h"

namespace tandem {

/// A scene and frames of a plan with the cells that are measured on them, in which order their results are
/// printed. The scene was opened, and is no longer: the ranks open it for themselves.
struct SweptGroup {
    RunOptions options; ///< with this scene and its frames
    std::string text;   ///< what is said of the scene
    std::uint64_t digest = 0;
    std::vector<Cell> cells;
    std::vector<std::string> keys;                  ///< [cell], of what was asked for
    std::vector<std::optional<double>> seconds{};   ///< [cell], that it took before; none: not known
    std::vector<std::optional<CellResult>> results; ///< [cell]
    std::vector<int> ranks;                         ///< [cell], that measured it
    std::size_t open_hands = 0;                     ///< that have not ended
    std::size_t left_out = 0;                       ///< cells that have a record already
};

/// Opens the scene of a group, and leaves out the cells that have a record. Throws InputError where scene,
/// frames and cells do not fit each other.
SweptGroup open_group(const RunOptions& options, const CellGroup& group, const FinishedCells& finished,
                      Unfinished& unfinished);

/// Prints its scene and the tables of what was measured.
void print_group(const SweptGroup& group);

/// --dry-run: prints its cells and which ranks would be asked. Returns the seconds that they are known or
/// asked to take.
double list_group(const SweptGroup& group, const Roster& roster, std::size_t& number);

} // namespace tandem
