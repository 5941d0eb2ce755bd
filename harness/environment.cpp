// SPDX-License-Identifier: MIT
#include "harness/environment.h"

#include "commit.h"

#include <algorithm>
#include <chrono>
#include <fmt/chrono.h>
#include <fstream>
#include <random>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>

namespace tandem {

namespace {

constexpr auto compiler = "g++ " __VERSION__;

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return {};
}

/// The number that follows `name` in a file of names and numbers; `unknown` when there is none.
std::uint64_t number_in(const std::string& path, std::string_view name, std::uint64_t unknown) {
    std::ifstream file(path);
    std::string word;
    for (std::uint64_t value = 0; file >> word;)
        if (word == name && file >> value) return value;
    return unknown;
}

constexpr auto unlimited = ~std::uint64_t{0};

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

/// Arguments apart by blanks, in single quotes where they hold one.
std::string without_folders(std::string_view line) {
    std::string result;
    while (!line.empty()) {
        const auto end = std::min(line.find_first_of(" '=,"), line.size() - 1) + 1;
        auto word = line.substr(0, end);
        if (word.front() == '/') word.remove_prefix(word.rfind('/') + 1);
        result += word;
        line.remove_prefix(end);
    }
    return result;
}

std::string command_line() {
    std::ifstream file("/proc/self/cmdline", std::ios::binary);
    std::string line;
    for (std::string word; std::getline(file, word, '\0');) {
        if (line.empty()) word = word.substr(word.rfind('/') + 1);
        const bool plain = !word.empty() && word.find_first_of(" '\"\t\n") == std::string::npos;
        line += (line.empty() ? "" : " ") + (plain ? word : "'" + word + "'");
    }
    return line;
}

std::string version_line() {
    const std::string commit = TANDEM_COMMIT_ID;
    return fmt::format("tandem {}, commit {}{}, {}, {}", TANDEM_VERSION, commit.empty() ? "unknown" : commit,
                       TANDEM_COMMIT_DIRTY ? ", dirty" : "", compiler, TANDEM_PARTS);
}

std::string sources_digest() { return TANDEM_SOURCES; }

const std::string& session_id() {
    static const auto id = [] {
        std::random_device chance;
        return fmt::format("{:08x}{:08x}", chance(), chance());
    }();
    return id;
}

Environment environment() {
    Environment result;
    result.commit = TANDEM_COMMIT_ID;
    result.dirty = TANDEM_COMMIT_DIRTY;
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    result.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", now);
    result.processor = processor_name();
    result.cores = std::thread::hardware_concurrency();
    result.memory = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES))
                    * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
    result.compiler = compiler;
    return result;
}

} // namespace tandem
