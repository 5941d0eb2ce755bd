// SPDX-License-Identifier: MIT
// paper: the package python/tandem/paper measures and draws.
#include "harness/commands/options/external_options.h"
#include "harness/plans/device_groups.h"
#include "harness/commands/external.h"
#include "base/error.h"

#include <CLI/CLI.hpp>
#include <array>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Throws InputError unless there is such a device, and it is one.
void check_is_one_device(const std::string& device) {
    const auto backends = open_backends(std::array{device}, {});
    const auto group = choose_devices(backends, std::array{device});
    if (group.size() != 1 || group.front().size() != 1)
        throw InputError(
            fmt::format("--device {}: the paper's scenes run on one device; name exactly one", device));
}

int run_paper(const CLI::App& app, const std::string& device) {
    if (app.count("--output") == 0) throw InputError("no folder for tables and figures; give -o FOLDER");
    if (app.count("--draw-only") == 0) check_is_one_device(device);
    return run_external("paper", given_words(app));
}

} // namespace

Action add_paper(CLI::App& app) {
    auto device = std::make_shared<std::string>(default_device);
    add_external_option(app, "-o,--output", "the folder for tables, figures, records and index.html");
    app.add_option("--device", *device,
                   fmt::format("the device to measure on (default: {})", default_device));
    add_external_option(app, "--size",
                        "scenes: small, for a processor (15 minutes on two cores), or full, those of the "
                        "paper, for a GPU (default: small)")
        ->option_text("small|full");
    add_external_option(app, "--steps",
                        "only these of the steps that --dry-run lists: FIRST:LAST or N; or tableN, figureN "
                        "or a name, with the steps that make their recordings; several with commas "
                        "(default: all)");
    add_external_flag(app, "--again", "measure again what is already done");
    add_external_flag(app, "--measure-only", "draw nothing; draw later with --draw-only, on any machine");
    add_external_flag(app, "--draw-only",
                      "draw tables, figures and verdicts from the records of the folder; measure nothing");
    add_external_flag(app, "--dry-run", "list the steps and their times; measure nothing");
    return [&app, device] { return run_paper(app, *device); };
}

} // namespace tandem
