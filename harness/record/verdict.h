// SPDX-License-Identifier: MIT
#pragma once

#include "harness/frames/frames.h"
#include "harness/sampling/measurement.h"
#include "harness/sampling/ratio.h"

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace tandem {

/// A measured cell among the others of its run.
struct Row {
    const Cell* cell;
    const Measurement* measurement;
    std::string key = {}; ///< of its record
};

/// Whether the ratio of two cells' times has a meaning: equal devices, bounds (k, axes, precision, rounding,
/// placement, origin) and output, and both right with at least one pair. The rows have one scene.
bool comparable(const Row& a, const Row& b);

/// A cell of a verdict, compared with the fastest.
struct RankedCell {
    std::size_t row = 0;    ///< index of its row
    double median_ns = 0;   ///< of its rounds; a replay of all frames
    std::size_t rounds = 0; ///< rounds that both have; their ratios are paired
    Ratio ratio; ///< its time to that of the fastest; without an interval for fewer rounds than five

    /// The ratios of all of n rounds lie on one side of the true one by chance in 2 of 2^n cases: 6 % for
    /// five.
    bool has_interval() const { return rounds >= 5; }
    /// Whether the interval excludes 1.
    bool is_told_apart() const { return has_interval() && (ratio.low > 1 || ratio.high < 1); }
};

/// Which of several comparable cells is the fastest, and which others are told apart from it.
/// python/tandem/verdicts.py reads it, and has the same rule for records of several runs.
struct Verdict {
    std::vector<RankedCell> cells; ///< the fastest, then the others by their ratios to it
    bool answers_differ = false;   ///< unchecked cells found different pairs: none is the fastest

    /// Whether no cell is told to be faster: the first, and those with an interval that contains 1.
    bool is_leader(const RankedCell& cell) const;
};

/// Ratio of the times of two cells over the rounds that both have. Without such rounds it is the ratio of
/// the medians.
RankedCell compared(const Measurement& m, const Measurement& fastest);

/// One verdict for each set of at least two comparable rows with samples, in the order of their first rows.
std::vector<Verdict> verdicts_of(std::span<const Row> rows);

/// "A is fastest: 1.2 ms per frame, 1.5 times as fast as B [1.4, 1.6]." Where an interval contains 1: "A and
/// B cannot be told apart with 5 rounds (ratio [0.9, 1.1]); try --repeat 20." `labels` are the names of all
/// rows.
std::string verdict_sentence(const Verdict& verdict, std::span<const Row> rows,
                             std::span<const std::string> labels);

/// What tells the cells of a verdict from those of the others, "k=8, host: ", because cells with different
/// bounds are not compared with each other; empty for a single verdict.
std::string verdict_scope(const Verdict& verdict, std::span<const Verdict> all, std::span<const Row> rows);

/// The line of results/verdict.schema.json. `rows` have keys.
nlohmann::ordered_json verdict_record(const Verdict& verdict, std::span<const Row> rows, const Scene& scene,
                                      const FrameRange& range);

} // namespace tandem
