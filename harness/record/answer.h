// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/job.h"

#include <string>
#include <vector>

namespace tandem {

/// The last printed line of a cell: right, or the number of wrong answers.
std::string answer_text(const Measurement& m);

/// What the rounding of vertices changed, against the input's doubles.
std::string rounding_text(const RoundingErrors& errors);

/// A line for each reason not to rely on the answer, although it is the rule's or the precision's own.
std::vector<std::string> answer_warnings(const Measurement& m, const Scene& scene);

/// Reasons to doubt a cell's times, such as disturbed rounds or drift; empty when there are none.
std::string doubts(const CellResult& result);

} // namespace tandem
