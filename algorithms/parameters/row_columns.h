// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "scenes/contact.h"

#include <span>
#include <string>
#include <string_view>

namespace tandem {

/// A column of the rows that a contact rule makes, beside their pairs.
struct RowColumn {
    std::string_view name;    ///< "normal"
    std::string_view csv;     ///< "nx,ny,nz"; a word for each number
    std::string_view unit;    ///< "length", in the scene's unit; "1"
    std::string_view meaning; ///< one line
    /// Its numbers, as many as words of csv.
    std::span<const double> (*values)(const ContactPoint& row, std::array<double, 3>& room);
};

/// The columns of the rows of a rule with an output, in the order of files. Files and their headers follow
/// from them.
std::span<const RowColumn> row_columns(ContactRule rule, Output output);

/// The header of a file with a line for each row: the frame, the pair, and the columns.
std::string row_header(std::span<const RowColumn> columns);

} // namespace tandem
