// SPDX-License-Identifier: MIT
// paper: measured and drawn by the package python/tandem/paper.
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

/// Bytes of the array that the paper's release allocates for queues: a quarter of the device's memory, at
/// most what one buffer holds. Throws InputError where there is no such device.
std::uint64_t queue_bytes_on(const std::string& device) {
    const auto backends = open_backends(std::array{device}, {});
    const auto group = choose_devices(backends, std::array{device});
    if (group.size() != 1 || group.front().size() != 1)
        throw InputError(fmt::format("--device {}: the paper's scenes are on one device; name it", device));
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
    auto device = std::make_shared<std::string>("opencl:0");
    add_external_option(app, "-o,--output", "the folder of tables, figures, records and index.html");
    app.add_option("--device", *device, "where; opencl:0 when left out");
    add_external_option(app, "--size",
                        "small|full: scenes for a processor, within 15 minutes on two cores, or those of the "
                        "paper, for a GPU; small when left out")
        ->option_text("small|full");
    add_external_option(app, "--steps", "FIRST:LAST or N of those that --dry-run lists; all when left out");
    add_external_flag(app, "--again", "measure anew what is done already");
    add_external_flag(app, "--measure-only",
                      "draw nothing; --draw-only does so later, also on another machine");
    add_external_flag(app, "--draw-only",
                      "tables, figures and verdicts of what the folder has; measure nothing");
    add_external_flag(app, "--dry-run", "list the steps and how long they take; measure none");
    return [&app, device] { return run_paper(app, *device); };
}

} // namespace tandem
