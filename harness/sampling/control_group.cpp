// SPDX-License-Identifier: MIT
#include "harness/sampling/control_group.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace tandem {

namespace {

/// The mount point of a hierarchy that limits processors, and the group of this process in it.
struct Membership {
    std::filesystem::path mount;
    std::filesystem::path group;
};

/// A line of /proc/self/cgroup is "number:controllers:path"; version 2 has number 0 and no controllers.
std::optional<Membership> membership(const std::filesystem::path& root, const std::string& line) {
    const auto first = line.find(':');
    const auto second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) return std::nullopt;
    const auto controllers = line.substr(first + 1, second - first - 1);
    const auto group = std::filesystem::path(line.substr(second + 1)).relative_path();
    const auto mounts = root / "sys/fs/cgroup";
    if (controllers.empty()) return Membership{mounts, group};
    // "cpu,cpuacct", but neither "cpuacct" nor "cpuset" alone.
    std::istringstream names(controllers);
    for (std::string name; std::getline(names, name, ',');)
        if (name == "cpu") return Membership{mounts / controllers, group};
    return std::nullopt;
}

/// Version 2 has one file, "QUOTA PERIOD" or "max PERIOD"; version 1 has two files, and -1 for no limit.
std::optional<double> quota_of(const std::filesystem::path& folder) {
    double quota = 0;
    double period = 0;
    std::ifstream file(folder / "cpu.max");
    if (!(file >> quota >> period)) {
        std::ifstream quota_file(folder / "cpu.cfs_quota_us"), period_file(folder / "cpu.cfs_period_us");
        if (!(quota_file >> quota) || !(period_file >> period)) return std::nullopt;
    }
    if (quota <= 0 || period <= 0) return std::nullopt;
    return quota / period;
}

std::optional<std::uint64_t> throttled_of(const std::filesystem::path& folder) {
    std::ifstream file(folder / "cpu.stat");
    std::string name;
    for (std::uint64_t value = 0; file >> name >> value;)
        if (name == "nr_throttled") return value;
    return std::nullopt;
}

void add_folder(ControlGroup& sum, const std::filesystem::path& folder) {
    if (const auto cores = quota_of(folder)) sum.cores = std::min(*cores, sum.cores.value_or(*cores));
    if (const auto throttled = throttled_of(folder)) sum.throttled = *throttled + sum.throttled.value_or(0);
}

} // namespace

ControlGroup read_control_group(const std::string& root) {
    ControlGroup sum;
    std::ifstream file(std::filesystem::path(root) / "proc/self/cgroup");
    for (std::string line; std::getline(file, line);) {
        const auto member = membership(root, line);
        if (!member) continue;
        // In a container the path can be that of the host, of which only the mount itself exists.
        for (auto group = member->group; !group.empty(); group = group.parent_path())
            add_folder(sum, member->mount / group);
        add_folder(sum, member->mount);
    }
    return sum;
}

} // namespace tandem
