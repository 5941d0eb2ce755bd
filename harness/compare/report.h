// SPDX-License-Identifier: MIT
// What is said of a comparison: the parts that its texts share, and the texts.
#pragma once

#include "harness/compare/columns.h"
#include "harness/text_lines.h"
#include "harness/compare/compare.h"

namespace tandem::compare {

/// A comparison and what it is of; points to all of it.
struct Report {
    const RecordedCells& before;
    const RecordedCells& after;
    const Options& options;
    const Comparison& comparison;
};

/// "slower", "faster", "within the threshold", "≈", "too few samples to tell", "another answer".
std::string_view words_of(Verdict verdict);

/// What the compared cells share, and a row for each under a heading: cell, old ms, new ms, new/old with its
/// interval, corrected p, verdict, least effect that would show. "-" where there is none.
std::string common_names(const Report& report);
std::vector<TableRow> table_rows(const Report& report);

/// A sentence for each other answer, for each record that takes no part (ten at most), and for what else a
/// reader has to know of the files: lines that were ignored, cells without a counterpart, other devices.
std::vector<std::string> notes(const Report& report);

/// The last line: how many are slower and faster, beyond what, and what the others could have shown.
std::string summary(const Report& report);

/// The whole report: for terminals, for pull requests, and for programs (with keys and everything else).
std::string text_of(const Report& report);
std::string markdown_of(const Report& report);
std::string json_of(const Report& report);

} // namespace tandem::compare
