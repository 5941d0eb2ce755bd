// SPDX-License-Identifier: MIT
// compare: records of two times or commits.
#include "harness/commands/options/external_options.h"

#include <CLI/CLI.hpp>

namespace tandem {

Action add_compare(CLI::App& app) {
    add_external_option(app, "old", "FILE.jsonl of records, or FILE.jsonl@COMMIT for those of one commit")
        ->required();
    add_external_option(app, "new", "likewise; the same file with two commits will do")->required();
    add_external_option(app, "--threshold",
                        "percent by which a cell has to change; 1 on GPUs and 3 on processors when left out")
        ->check(CLI::Range(0.0, 1e6))
        ->option_text("P");
    add_external_option(app, "--level",
                        "probability of any false alarm, all cells together; 0.05 when left out")
        ->check(CLI::Range(1e-9, 0.5))
        ->option_text("A");
    add_external_option(app, "--format", "text, json or markdown; text when left out")
        ->check(CLI::IsMember({"text", "json", "markdown"}))
        ->option_text("text|json|markdown");
    add_external_option(app, "--commit-old", "of OLD only records of the commit that begins so")
        ->option_text("C");
    add_external_option(app, "--commit-new", "of NEW only records of the commit that begins so")
        ->option_text("D");
    return run_external_action(app);
}

} // namespace tandem
