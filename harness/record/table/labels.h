// SPDX-License-Identifier: MIT
#pragma once

#include "harness/record/table/table.h"

#include <vector>

namespace tandem {

/// Names of cells in a table.
struct RowLabels {
    std::vector<std::string> by_row; ///< one a row: algorithm, and what differs among the rows
    std::string common;              ///< what all rows share and no preset implies
};

RowLabels row_labels(std::span<const Row> rows);

} // namespace tandem
