// SPDX-License-Identifier: MIT
#include "harness/plans/rank_team.h"

#include "algorithms/parameters/table.h"
#include "algorithms/distributed/job_session.h"
#include "harness/plans/device_models.h"
#include "harness/plans/cell_groups.h"
#include "harness/plans/cells.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <thread>
#include <unistd.h>

namespace tandem {

namespace {

/// Divides the processor among the machine's ranks, unless the launcher has bound each rank to some cores.
std::int64_t threads_of_a_rank(const LocalRank& local) {
    const auto usable = static_cast<std::int64_t>(std::thread::hardware_concurrency());
    const bool is_bound = usable < sysconf(_SC_NPROCESSORS_ONLN);
    return std::max<std::int64_t>(1, is_bound ? usable : usable / static_cast<std::int64_t>(local.count));
}

} // namespace

std::string RankTeam::own_device(const RunOptions& options) const {
    const auto names = devices_of(plan_of(options));
    if (names.size() > 1)
        throw InputError(fmt::format(
            "{} are devices of several cells, but all ranks share each cell; name one device with --device, "
            "or join one for each rank of a machine with +",
            fmt::join(names, ", ")));
    if (names.front() == "all")
        throw InputError(
            "--device all makes several cells, but all ranks share each cell; name their devices");
    return device_of_rank(names.front(), local_rank_);
}

std::string RankTeam::own_of_each(const std::string& name, const std::vector<BackendReport>& backends) const {
    std::vector<std::string> ids;
    for (const auto& backend : backends)
        for (const auto& device : backend.devices)
            if (is_among(device->info(), name)) ids.push_back(device->info().id);
    if (ids.empty()) throw InputError(fmt::format("--device {}: there is no device of that back end", name));
    return ids[local_rank_.before % ids.size()];
}

void RankTeam::open(const Device& own) {
    if (const auto text = shared_gpu(ranks_, own.info()); !text.empty()) throw SharedError<InputError>(text);
    devices_ = devices_of_ranks(ranks_, own.info());
}

void RankTeam::check_same(const std::string& own) {
    const auto first = decided(own);
    together([&] {
        if (own != first)
            throw InputError("its scene or cells differ from those of rank 0; give all ranks the same files");
    });
}

Settings RankTeam::settings_of(const Cell& cell) const {
    auto settings = cell.settings;
    if (settings[parameters::threads] == 0 && cell.devices.front()->info().id == "host")
        settings.set(parameters::threads(threads_of_a_rank(local_rank_)));
    return settings;
}

std::unique_ptr<Session> RankTeam::prepare(const Cell& cell, const Scene& scene) {
    const auto settings = settings_of(cell);
    together([&] { cell.algorithm->check(cell.devices, settings); });
    try {
        return std::make_unique<JobSession>(
            ranks_, cell.algorithm->prepare(*cell.devices.front(), scene, settings, ranks_));
    } catch (const InputError& error) { // the settings are the same on all ranks, and so is this error
        throw SharedError<InputError>(error.what());
    }
}

} // namespace tandem
