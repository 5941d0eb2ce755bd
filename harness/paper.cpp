// SPDX-License-Identifier: MIT
// `tandem paper`: measured and drawn by the package python/tandem/paper.
#include "harness/commands.h"
#include "harness/device_groups.h"
#include "harness/external.h"
#include "scenes/error.h"

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

} // namespace

int paper_command(const PaperOptions& options) {
    if (options.folder.empty()) throw InputError("no folder for tables and figures; give -o FOLDER");
    std::vector<std::string> words{"--output=" + options.folder, "--size=" + options.size,
                                   "--device=" + options.device, "--steps=" + options.steps};
    if (!options.draw_only) words.push_back(fmt::format("--queue-bytes={}", queue_bytes_on(options.device)));
    for (const auto& [given, word] :
         {std::pair{options.again, "--again"}, std::pair{options.measure_only, "--measure-only"},
          std::pair{options.draw_only, "--draw-only"}, std::pair{options.dry_run, "--dry-run"}})
        if (given) words.emplace_back(word);
    return run_external("paper", words);
}

} // namespace tandem
