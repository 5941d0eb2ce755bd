// SPDX-License-Identifier: MIT
#include "harness/commands.h"
#include "harness/compare/report.h"
#include "harness/standard_streams.h"

namespace tandem {

int compare_command(const CompareOptions& options) {
    const auto before = compare::read_cells(options.before, options.commit_before);
    const auto after = compare::read_cells(options.after, options.commit_after);
    compare::Options how;
    how.level = options.level;
    if (options.threshold) how.threshold = *options.threshold / 100;
    const auto comparison = compare::compare(before, after, how);
    const compare::Report report{before, after, how, comparison};
    put("{}", options.format == "json"       ? compare::json_of(report)
              : options.format == "markdown" ? compare::markdown_of(report)
                                             : compare::text_of(report));
    return comparison.changed() ? 1 : 0;
}

} // namespace tandem
