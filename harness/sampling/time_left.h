// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace tandem {

/// A part of the work of a cell: the seconds that it took so far, and the fraction of it that is done.
struct WorkDone {
    double seconds = 0, fraction = 0;
};

/// The work of a cell: its check (with reference, truth and the replay that counts), and its rounds.
struct CellWork {
    WorkDone check, rounds;
};

/// Estimated seconds to the end of these cells and of `later` more. A part of a cell that has begun goes on
/// as it began; one that has not takes the mean of the others. `usual_rounds`: seconds of the rounds of a
/// cell, while no cell has any; none: unknown. The result is empty while a part of the work is unknown.
std::optional<double> seconds_left(std::span<const CellWork> cells, std::size_t later,
                                   std::optional<double> usual_rounds);

} // namespace tandem
