// SPDX-License-Identifier: MIT
// paper: the package python/tandem/paper measures and draws.
#include "harness/commands/options/external_options.h"
#include "harness/plans/device_groups.h"
#include "harness/commands/external.h"
#include "base/error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace tandem {

namespace {

/// The size in bytes of the array that the paper's release allocates for queues: a quarter of the device's
/// memory, limited to one buffer. Throws InputError when there is no such device.
std::uint64_t queue_bytes_on(const std::string& device) {
    const auto backends = open_backends(std::array{device}, {});
    const auto group = choose_devices(backends, std::array{device});
    if (group.size() != 1 || group.front().size() != 1)
        throw InputError(
            fmt::format("--device {}: the paper's scenes run on one device; name exactly one", device));
    const auto& info = group.front().front()->info();
    return std::min(info.global_bytes / 4, info.max_allocation);
}

int run_paper(const CLI::App& app, const std::string& device) {
    if (app.count("--output") == 0) throw InputError("no folder for tables and figures; give -o FOLDER");
    auto words = given_words(app);
    if (app.count("--draw-only") == 0)
        words.insert(words.begin(), fmt::format("--queue-bytes={}", queue_bytes_on(device)));
    return run_external("paper", words);
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
                        "FIRST:LAST or N: only these of the steps that --dry-run lists (default: all)");
    add_external_flag(app, "--again", "measure again what is already done");
    add_external_flag(app, "--measure-only", "draw nothing; draw later with --draw-only, on any machine");
    add_external_flag(app, "--draw-only",
                      "draw tables, figures and verdicts from the records of the folder; measure nothing");
    add_external_flag(app, "--dry-run", "list the steps and their times; measure nothing");
    return [&app, device] { return run_paper(app, *device); };
}

} // namespace tandem
