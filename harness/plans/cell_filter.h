// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"

#include <memory>
#include <string>
#include <string_view>

namespace tandem {

/// Chooses cells by their names, as describe() gives them and tables show them.
class CellFilter {
public:
    /// `expression`: a POSIX extended regular expression, as of grep -E; empty: every cell. Throws InputError
    /// for any other text.
    explicit CellFilter(const std::string& expression);
    ~CellFilter();
    CellFilter(const CellFilter&) = delete;
    CellFilter& operator=(const CellFilter&) = delete;

    /// Whether the expression matches some part of the cell's name.
    bool matches(const Cell& cell) const;
    /// Removes cells that do not match.
    void apply(std::vector<Cell>& cells) const;
    /// Throws InputError: none of `count` cells matches. `example` is one of them.
    [[noreturn]] void refuse_none(std::size_t count, const Cell& example) const;

private:
    struct Expression;
    std::string text_;
    std::unique_ptr<Expression> expression_; ///< null: every cell
};

/// Removes cells that do not match. Throws InputError when none matches.
void keep_matching(std::vector<Cell>& cells, const std::string& expression);

} // namespace tandem
