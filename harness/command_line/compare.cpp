// SPDX-License-Identifier: MIT
// compare: records of two times or commits.
#include "harness/command_line/actions.h"
#include "harness/commands.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace tandem {

Action add_compare(CLI::App& app) {
    auto given = std::make_shared<CompareOptions>();
    auto& options = *given;
    app.add_option("old", options.before,
                   "FILE.jsonl of records, or FILE.jsonl@COMMIT for those of one commit")
        ->required();
    app.add_option("new", options.after, "likewise; the same file with two commits will do")->required();
    app.add_option("--threshold", options.threshold,
                   "percent by which a cell has to change; 1 on GPUs and 3 on processors when left out")
        ->check(CLI::Range(0.0, 1e6))
        ->option_text("P");
    app.add_option("--level", options.level,
                   "probability of any false alarm, all cells together; 0.05 when left out")
        ->check(CLI::Range(1e-9, 0.5))
        ->option_text("A");
    app.add_option("--format", options.format, "text, json or markdown; text when left out")
        ->check(CLI::IsMember({"text", "json", "markdown"}))
        ->option_text("text|json|markdown");
    app.add_option("--commit-old", options.commit_before, "of OLD only records of the commit that begins so")
        ->option_text("C");
    app.add_option("--commit-new", options.commit_after, "of NEW only records of the commit that begins so")
        ->option_text("D");
    return [given] { return compare_command(*given); };
}

} // namespace tandem
