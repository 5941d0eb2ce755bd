// SPDX-License-Identifier: MIT
// compare: records of two runs or commits, or two programs.
#include "harness/commands/options/external_options.h"

#include <CLI/CLI.hpp>

namespace tandem {

namespace {

/// The options that measure two programs by turns.
void add_run_options(CLI::App& app) {
    auto* run = add_external_flag(app, "--run",
                                  "OLD and NEW are two builds of this program; measure both by turns and "
                                  "compare: --run OLD NEW -- SCENE ...");
    const auto with_run = [&](const char* name, const char* description) {
        return add_external_option(app, name, description)->needs(run);
    };
    with_run("words", "with --run, behind --: scenes or a plan, and options of 'tandem run'")
        ->expected(CLI::detail::expected_max_vector_size);
    with_run("--sessions", "with --run: processes of each program (default: 12)")
        ->check(CLI::Range(2, 1000))
        ->option_text("N");
    with_run("--out", "with --run: keep the records in this folder, which must be new or empty")
        ->option_text("FOLDER");
    for (const char* name : {"--commit-old", "--commit-new"}) app.get_option(name)->excludes(run);
}

} // namespace

Action add_compare(CLI::App& app) {
    add_external_option(app, "old",
                        "FILE.jsonl of records, or FILE.jsonl@COMMIT for the records of one commit")
        ->required();
    add_external_option(app, "new", "as OLD; may be the same file with another commit")->required();
    add_external_option(
        app, "--threshold",
        "least change of a cell that counts, in percent (default: 1 on GPUs, 3 on processors)")
        ->check(CLI::Range(0.0, 1e6))
        ->option_text("P");
    add_external_option(
        app, "--level",
        "probability of any false alarm over all cells together (default: 0.05, with --run 0.01)")
        ->check(CLI::Range(1e-9, 0.5))
        ->option_text("A");
    add_external_option(app, "--format", "format of the output (default: text)")
        ->check(CLI::IsMember({"text", "json", "markdown"}))
        ->option_text("text|json|markdown");
    add_external_option(app, "--commit-old", "use only the records of OLD whose commit begins with this text")
        ->option_text("C");
    add_external_option(app, "--commit-new", "use only the records of NEW whose commit begins with this text")
        ->option_text("D");
    add_external_flag(app, "--strict", "exit with 1 also if a cell changes in disturbed rounds only");
    add_run_options(app);
    return run_external_action(app);
}

} // namespace tandem
