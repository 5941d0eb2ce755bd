// SPDX-License-Identifier: MIT
#include "base/memory.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <sys/resource.h>

namespace tandem {

namespace {

constexpr auto unlimited = ~std::uint64_t{0};

/// The number that follows `name` in a file of names and numbers; `unknown` when there is none.
std::uint64_t number_in(const char* path, std::string_view name, std::uint64_t unknown) {
    std::ifstream file(path);
    std::string word;
    for (std::uint64_t value = 0; file >> word;)
        if (word == name && file >> value) return value;
    return unknown;
}

/// What ulimit -v leaves; unlimited where there is none.
std::uint64_t free_address_space() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
    const auto used = number_in("/proc/self/status", "VmSize:", 0) << 10;
    return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

/// Of version 2, as it shows in a container. What it keeps of files can be dropped.
std::uint64_t free_control_group() {
    std::ifstream most_file("/sys/fs/cgroup/memory.max"), used_file("/sys/fs/cgroup/memory.current");
    std::uint64_t most = 0, used = 0;
    if (!(most_file >> most) || !(used_file >> used)) return unlimited;
    used -= std::min(used, number_in("/sys/fs/cgroup/memory.stat", "inactive_file", 0));
    return most > used ? most - used : 0;
}

} // namespace

std::uint64_t free_memory() {
    const auto available = number_in("/proc/meminfo", "MemAvailable:", unlimited >> 10) << 10;
    return std::min({available, free_control_group(), free_address_space()});
}

void refuse_beyond_memory(std::string_view what, double bytes) {
    if (bytes < 1e8) return; // most scenes: nothing is looked up for them
    const auto free = static_cast<double>(free_memory());
    if (bytes <= free) return;
    throw InputError(
        fmt::format("{} take at least {:.2f} GB, and {:.2f} GB are free; use fewer bodies, a smaller mesh or "
                    "less refinement",
                    what, bytes / 1e9, free / 1e9));
}

} // namespace tandem
