// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/measurement.h"

#include <string>
#include <vector>

namespace tandem {

/// What is printed of a cell's answer: right, or the number of wrong answers.
std::string answer_text(const Measurement& m);

/// What the rounding of vertices changed, against the input's doubles.
std::string rounding_text(const RoundingErrors& errors);

/// A line for each reason not to rely on the answer, although it is the rule's or the precision's own.
std::vector<std::string> answer_warnings(const Measurement& m, const Scene& scene);

/// Whether a cell missed pairs although its rounding is safe or directed. These roundings miss no pair that
/// touches or overlaps (theorems of algorithms/bounds); other roundings guarantee nothing.
bool misses_against_its_promise(const Measurement& m);

} // namespace tandem
