// SPDX-License-Identifier: MIT
#include "harness/paper/paper_folder.h"

#include "harness/environment.h"
#include "harness/programs.h"
#include "scenes/durable.h"
#include "scenes/error.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>

namespace tandem {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// With the plan that it runs, as a step is done again when that has changed.
std::string key_of(const PaperStep& step) {
    return fmt::format("{} {}", fmt::join(step.command, " "), step.plan.is_null() ? "" : step.plan.dump());
}

/// Of a simulation that has begun: a recording to go on with.
bool has_recording(const PaperStep& step, const std::string& folder) {
    const auto& words = step.command;
    const auto name = std::find(words.begin(), words.end(), "-o");
    return words.front() == "simulate" && name != words.end()
           && fs::exists(folder + "/" + *std::next(name) + ".checkpoint");
}

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

} // namespace

PaperFolder::PaperFolder(std::string path, const std::string& size, const std::string& device)
    : path_(std::move(path)), size_(size), device_(device) {
    for (const char* part : {"records", "plans", "logs"}) {
        std::error_code code;
        fs::create_directories(path_ + "/" + part, code);
        if (code)
            throw InputError(
                fmt::format("-o {}: cannot be made a folder ({}); name another", path_, code.message()));
    }
    journal_.emplace(path_ + "/steps.jsonl");
    read_steps();
}

void PaperFolder::read_steps() {
    journal_->for_each([&](const nlohmann::ordered_json& line) {
        if (line.value("size", "") != size_ || line.value("device", "") != device_)
            throw InputError(fmt::format(
                "-o {}: has results of size {} on {}; name another folder, or that size and device", path_,
                line.value("size", "?"), line.value("device", "?")));
        const auto key = line.value("key", "");
        if (line.value("exit", 1) == 0)
            done_.insert(key);
        else
            done_.erase(key);
    });
}

bool PaperFolder::is_done(const PaperStep& step) const { return done_.contains(key_of(step)); }

void PaperFolder::write_plan(const PaperStep& step) const {
    if (step.plan.is_null()) return;
    const auto path = fmt::format("{}/plans/{}.json", path_, step.name);
    std::ofstream file(path);
    file << step.plan.dump(2) << '\n';
    if (!file.flush()) throw OutputError(fmt::format("{}: cannot be written", path));
}

int PaperFolder::run(const PaperStep& step) {
    write_plan(step);
    const auto log = fs::absolute(log_of(step)).string();
    fs::remove(log);
    std::vector<std::string> words{fs::read_symlink("/proc/self/exe").string()};
    words.insert(words.end(), step.command.begin(), step.command.end());
    if (has_recording(step, path_)) words.emplace_back("--resume");
    const auto begin = Clock::now();
    const int code = run_program(words, {path_, log, log});
    // The line says for good that it is done: what it and the programs that it ran have written has to last.
    sync_file_system_of(path_);
    const auto now = environment();
    journal_->append({{"step", step.name},
                      {"size", size_},
                      {"device", device_},
                      {"exit", code},
                      {"seconds", seconds_since(begin)},
                      {"says", step.says},
                      {"command", fmt::format("tandem {}", fmt::join(step.command, " "))},
                      {"key", key_of(step)},
                      {"commit", now.commit},
                      {"dirty", now.dirty},
                      {"date", now.date}});
    if (code == 0) done_.insert(key_of(step));
    return code;
}

std::string PaperFolder::last_line(const PaperStep& step) const {
    std::ifstream file(log_of(step));
    std::string last;
    for (std::string line; std::getline(file, line);)
        if (!line.empty()) last = line;
    return last;
}

void PaperFolder::forget(const PaperStep& step) {
    done_.erase(key_of(step));
    std::error_code none; // what is not there needs no removing
    for (const auto& word : step.command)
        if (word.ends_with(".jsonl") || word.ends_with(".frames")) {
            fs::remove(path_ + "/" + word, none);
            fs::remove(path_ + "/" + word + ".checkpoint", none);
        }
}

} // namespace tandem
