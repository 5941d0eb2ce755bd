// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/job.h"

namespace tandem {

/// The last line of a cell: right, or by how much not.
std::string verdict(const Measurement& m);

/// What is to be thought of a cell's times; empty when nothing speaks against them.
std::string doubts(const CellResult& result);

} // namespace tandem
