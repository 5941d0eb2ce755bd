// SPDX-License-Identifier: MIT
#include "harness/plans/cell_filter.h"

#include "base/counted.h"
#include "base/error.h"

#include <array>
#include <fmt/format.h>
#include <regex.h>

namespace tandem {

struct CellFilter::Expression {
    regex_t compiled{};
};

CellFilter::CellFilter(const std::string& expression) : text_(expression) {
    if (expression.empty()) return;
    auto parsed = std::make_unique<Expression>();
    const int error = regcomp(&parsed->compiled, expression.c_str(), REG_EXTENDED | REG_NOSUB);
    if (error != 0) {
        std::array<char, 200> reason{};
        regerror(error, &parsed->compiled, reason.data(), reason.size());
        throw InputError(fmt::format("--filter '{}': is no regular expression ({}); write one as for grep -E",
                                     expression, reason.data()));
    }
    expression_ = std::move(parsed);
}

CellFilter::~CellFilter() {
    if (expression_) regfree(&expression_->compiled);
}

bool CellFilter::matches(const Cell& cell) const {
    return !expression_ || regexec(&expression_->compiled, describe(cell).c_str(), 0, nullptr, 0) == 0;
}

void CellFilter::apply(std::vector<Cell>& cells) const {
    std::erase_if(cells, [&](const Cell& cell) { return !matches(cell); });
}

void CellFilter::refuse_none(std::size_t count, const Cell& example) const {
    throw InputError(fmt::format("--filter '{}': matches none of {}; one of them is '{}'", text_,
                                 counted(count, "cell"), describe(example)));
}

void keep_matching(std::vector<Cell>& cells, const std::string& expression) {
    const CellFilter filter(expression);
    const auto all = cells;
    filter.apply(cells);
    if (cells.empty() && !all.empty()) filter.refuse_none(all.size(), all.front());
}

} // namespace tandem
