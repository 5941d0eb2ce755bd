// SPDX-License-Identifier: MIT
#include "harness/environment.h"

#include "commit.h"

#include <chrono>
#include <fmt/chrono.h>
#include <fstream>
#include <thread>
#include <unistd.h>

namespace tandem {

namespace {

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return {};
}

} // namespace

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
    result.compiler = "g++ " __VERSION__;
    return result;
}

} // namespace tandem
