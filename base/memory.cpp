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

/// The number after `name` in a file of names and numbers; `fallback` when `name` is missing.
std::uint64_t number_in(const char* path, std::string_view name, std::uint64_t fallback) {
    std::ifstream file(path);
    std::string word;
    for (std::uint64_t value = 0; file >> word;)
        if (word == name && file >> value) return value;
    return fallback;
}

/// The address space that ulimit -v leaves; `unlimited` without such a limit.
std::uint64_t free_address_space() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
    const auto used = number_in("/proc/self/status", "VmSize:", 0) << 10;
    return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

/// Memory left in the control group (version 2, at the paths of a container). Inactive file cache counts as
/// free, because the kernel can drop it.
std::uint64_t free_control_group() {
    std::ifstream limit_file("/sys/fs/cgroup/memory.max"), used_file("/sys/fs/cgroup/memory.current");
    std::uint64_t limit = 0, used = 0;
    if (!(limit_file >> limit) || !(used_file >> used)) return unlimited;
    used -= std::min(used, number_in("/sys/fs/cgroup/memory.stat", "inactive_file", 0));
    return limit > used ? limit - used : 0;
}

} // namespace

std::uint64_t free_memory() {
    const auto available = number_in("/proc/meminfo", "MemAvailable:", unlimited >> 10) << 10;
    return std::min({available, free_control_group(), free_address_space()});
}

void refuse_beyond_memory(std::string_view what, double bytes) {
    if (bytes < 1e8) return; // most scenes are smaller and need no look-up
    const auto free = static_cast<double>(free_memory());
    if (bytes <= free) return;
    throw InputError(
        fmt::format("{} take at least {:.2f} GB, and {:.2f} GB are free; use fewer bodies, a smaller mesh or "
                    "less refinement",
                    what, bytes / 1e9, free / 1e9));
}

} // namespace tandem
