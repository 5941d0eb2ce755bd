// SPDX-License-Identifier: MIT
#pragma once

#include "harness/compare/cells.h"
#include "harness/compare/rank_tests.h"
#include "harness/compare/ratio.h"

namespace tandem::compare {

enum class Verdict {
    slower,           ///< p below the level, and the ratio beyond the threshold
    faster,           ///< likewise
    within_threshold, ///< p below the level, the ratio not beyond the threshold
    not_shown,        ///< p not below the level: no change, or one too small for so many rounds to show
    too_few,          ///< so few rounds that no times could have brought p below the level
    another_answer    ///< digests differ: times are of different work and not compared
};

/// One cell in both files. A round is the unit of every test: samples of one round share its preparation.
struct ComparedCell {
    const RecordedCell* before = nullptr;
    const RecordedCell* after = nullptr;
    Verdict verdict = Verdict::not_shown;
    bool paired = false;    ///< one session, interleaved: rounds of one number are pairs
    std::size_t common = 0; ///< rounds of both; of paired cells the others take no part
    double threshold = 0;   ///< 0.01 for 1 %; slower is a ratio above 1 + it, faster one below 1 / (1 + it)
    double before_ns = 0, after_ns = 0; ///< medians over rounds that take part
    Ratio ratio;
    RankTest test;           ///< signed ranks of logarithms where paired, rank sums otherwise
    double least_p = 1;      ///< that the test can give with so many rounds
    std::optional<double> p; ///< of the test, corrected; nothing of cells that could not be tested
    std::optional<double>
        least_effect;              ///< relative change shown with probability `power`; nothing: none would
    std::size_t rounds_needed = 0; ///< with too few: that would do, of each side
};

struct Options {
    double level = 0.05;             ///< probability of any false alarm among all cells
    std::optional<double> threshold; ///< of every cell; otherwise 0.01 on GPUs and 0.03 on processors
};

constexpr double power = 0.8;

struct Comparison {
    std::vector<ComparedCell> cells;                     ///< in the order of the old file
    std::vector<const RecordedCell*> only_old, only_new; ///< cells without a counterpart
    std::size_t tested = 0;                              ///< that Holm's correction is over

    std::size_t count(Verdict verdict) const;
    /// Something is slower, faster or another answer.
    bool changed() const;
};

/// Compares cells of equal keys; the result points into both. p-values are corrected over all cells whose
/// numbers of rounds could bring p below the level at all, which no time decides (Holm 1979; Tarone 1990).
/// The least effect is that of a cell which is the only one to change, at level / tested cells. Throws
/// InputError when no cell is in both.
Comparison compare(const RecordedCells& before, const RecordedCells& after, const Options& options);

} // namespace tandem::compare
