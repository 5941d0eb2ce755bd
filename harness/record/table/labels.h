// SPDX-License-Identifier: MIT
#pragma once

#include "harness/record/table/table.h"

#include <vector>

namespace tandem {

/// Names of cells in a table.
struct RowLabels {
    std::vector<std::string> of; ///< one a row: algorithm, and what differs among the rows
    std::string common;          ///< what all share and no preset says
};

RowLabels row_labels(std::span<const Row> rows);

} // namespace tandem
