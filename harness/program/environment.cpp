// SPDX-License-Identifier: MIT
#include "harness/program/environment.h"

#include "commit.h"
#include "harness/program/processor_name.h"

#include <algorithm>
#include <chrono>
#include <fmt/chrono.h>
#include <fstream>
#include <random>
#include <thread>
#include <unistd.h>

namespace tandem {

namespace {

constexpr auto compiler = "g++ " __VERSION__;

} // namespace

/// Expects arguments separated by blanks, and in single quotes where they contain a blank.
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
