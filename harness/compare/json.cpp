// SPDX-License-Identifier: MIT
#include "harness/compare/labels.h"
#include "harness/compare/report.h"

#include <nlohmann/json.hpp>

namespace tandem::compare {

namespace {

using Document = nlohmann::ordered_json;

/// One word for programs; the table's are for readers.
const char* name_of(Verdict verdict) {
    switch (verdict) {
    case Verdict::slower:
        return "slower";
    case Verdict::faster:
        return "faster";
    case Verdict::within_threshold:
        return "within_threshold";
    case Verdict::not_shown:
        return "not_shown";
    case Verdict::too_few:
        return "too_few";
    case Verdict::another_answer:
        break;
    }
    return "another_answer";
}

template<class Value>
Document or_null(const std::optional<Value>& value) {
    return value ? Document(*value) : Document();
}

Document or_null(const std::string& text) { return text.empty() ? Document() : Document(text); }

Document answer_json(const std::optional<Answer>& answer) {
    return answer ? Document{{"count", answer->count}, {"a", answer->a}, {"b", answer->b}} : Document();
}

Document origin_json(const RecordedCell& cell, double median_ns) {
    return {{"line", cell.line},
            {"median_ns", median_ns},
            {"samples", cell.samples},
            {"rounds", cell.rounds.size()},
            {"session", or_null(cell.session)},
            {"seed", or_null(cell.seed)},
            {"commit", or_null(cell.commit)},
            {"dirty", cell.dirty},
            {"digest", answer_json(cell.pairs)},
            {"contact_digest", answer_json(cell.contacts)}};
}

/// What the times say; null of cells with another answer.
Document times_json(const ComparedCell& cell) {
    if (cell.verdict == Verdict::another_answer) return nullptr;
    const auto test = std::string(cell.paired ? "signed ranks" : "rank sums");
    return {{"ratio", cell.ratio.value},
            {"low", cell.ratio.low},
            {"high", cell.ratio.high},
            {"log_error", cell.ratio.log_error},
            {"test", test + (cell.test.exact ? ", exact" : ", normal approximation")},
            {"p", cell.test.p},
            {"p_holm", or_null(cell.p)},
            {"least_p", cell.least_p},
            {"least_effect", or_null(cell.least_effect)},
            {"rounds_needed", cell.rounds_needed == 0 ? Document() : Document(cell.rounds_needed)}};
}

Document cell_json(const ComparedCell& cell, const std::string& label) {
    return {{"key", cell.before->key},
            {"label", label},
            {"verdict", name_of(cell.verdict)},
            {"threshold", cell.threshold},
            {"paired", cell.paired},
            {"common_rounds", cell.paired ? Document(cell.common) : Document()},
            {"times", times_json(cell)},
            {"old", origin_json(*cell.before, cell.before_ns)},
            {"new", origin_json(*cell.after, cell.after_ns)}};
}

Document file_json(const RecordedCells& side, const std::vector<const RecordedCell*>& only) {
    Document left_out = Document::array();
    for (const auto& cell : side.left_out)
        left_out.push_back({{"line", cell.line},
                            {"key", cell.key},
                            {"status", cell.status},
                            {"failure", or_null(cell.failure)}});
    Document keys = Document::array();
    for (const auto* cell : only) keys.push_back(cell->key);
    Document commits = Document::array();
    for (const auto& commit : side.commits) commits.push_back(or_null(commit));
    return {{"file", side.path},    {"records", side.records},   {"cells", side.cells.size()},
            {"commits", commits},   {"repeated", side.repeated}, {"torn", side.torn},
            {"left_out", left_out}, {"only_here", keys}};
}

} // namespace

std::string json_of(const Report& report) {
    const auto& comparison = report.comparison;
    Document json{{"level", report.options.level}, {"power", power},
                  {"tested", comparison.tested},   {"changed", comparison.changed()},
                  {"summary", summary(report)},    {"notes", notes(report)}};
    for (const auto verdict : {Verdict::slower, Verdict::faster, Verdict::within_threshold,
                               Verdict::not_shown, Verdict::too_few, Verdict::another_answer})
        json["verdicts"][name_of(verdict)] = comparison.count(verdict);
    json["old"] = file_json(report.before, comparison.only_old);
    json["new"] = file_json(report.after, comparison.only_new);
    std::vector<const RecordedCell*> cells;
    for (const auto& cell : comparison.cells) cells.push_back(cell.before);
    const auto labels = label(cells);
    json["cells"] = Document::array();
    for (std::size_t i = 0; i < cells.size(); ++i)
        json["cells"].push_back(cell_json(comparison.cells[i], labels.of[i]));
    // File names need not be UTF-8; JSON must be.
    return json.dump(2, ' ', false, Document::error_handler_t::replace) + "\n";
}

} // namespace tandem::compare
