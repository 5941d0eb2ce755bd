// SPDX-License-Identifier: MIT
#include "harness/plans/choosing/choice_cache.h"

#include "algorithms/sources.h"
#include "base/private_folder.h"
#include "harness/record/environment.h"
#include "harness/sampling/ranks/rank_team.h"
#include "base/digest.h"

#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }

/// The logarithm of n to base 4, rounded down; null for 0.
Json power_of_4(std::uint64_t n) { return n == 0 ? Json() : Json((std::bit_width(n) - 1) / 2); }

Json device_json(const Device& device) {
    const auto& info = device.info();
    const auto limit = device.memory_limit();
    return {{"backend", info.id.substr(0, info.id.find(':'))},
            {"name", info.name},
            {"driver", info.driver},
            {"compiler", info.compiler},
            {"compute_units", info.compute_units},
            {"memory_limit", limit == Device::no_memory_limit ? Json() : Json(limit)}};
}

/// Replaces a file atomically: readers get the whole old or the whole new text.
bool replace(const fs::path& file, const std::string& text) {
    auto temporary = file;
    temporary += fmt::format(".{}", ::getpid());
    std::ofstream out(temporary);
    out << text;
    out.close();
    std::error_code code;
    if (out) fs::rename(temporary, file, code);
    if (out && !code) return true;
    fs::remove(temporary, code);
    return false;
}

} // namespace

Json question_of(const Cell& cell, const Scene& scene, std::uint64_t pairs) {
    Json devices = Json::array();
    for (const auto* device : cell.devices) devices.push_back(device_json(*device));
    if (cell.team != nullptr) // those of the other ranks, without their limits
        for (const auto& info : cell.team->devices())
            devices.push_back({{"rank", info.name}, {"driver", info.driver}});
    std::string all;
    for (const auto& candidate : cell.candidates)
        all += fmt::format("{} {} {}\n", candidate.algorithm->name(), candidate.preset,
                           candidate.settings.texts());
    const bool deformable = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                        [](const auto& body) { return body.deformable; });
    return {{"devices", devices},
            {"bodies", power_of_4(scene.bodies.size())},
            {"tetrahedra", power_of_4(tetrahedron_count(scene))},
            {"candidate_pairs", power_of_4(pairs)},
            {"deformable", deformable},
            {"candidates", hex(digest_of(all))}};
}

fs::path ChoiceCache::file_of(const Json& question) const {
    return folder_ / fmt::format("choice-{}.json", hex(digest_of(question.dump())));
}

std::optional<Choice> ChoiceCache::find(const Json& question, std::string& warning) const {
    warning.clear();
    if (folder_.empty()) return std::nullopt;
    std::ifstream file(file_of(question));
    if (!file) return std::nullopt;
    try {
        const auto json = Json::parse(file);
        if (json.at("program").get<std::string>() != program_ || json.at("question") != question)
            return std::nullopt;
        return choice_of(json.at("choice"));
    } catch (const Json::exception&) {
        warning = fmt::format("{}: contains no valid choice; choosing again", file_of(question).string());
    }
    return std::nullopt;
}

std::string ChoiceCache::keep(const Json& question, const Choice& choice) const {
    if (folder_.empty()) return {};
    const auto code = make_own(folder_);
    const Json json{{"program", program_}, {"question", question}, {"choice", choice_json(choice)}};
    // Keys of scenes may contain file names that are not UTF-8, which JSON requires.
    if (!code && replace(file_of(question), json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"))
        return {};
    return fmt::format("{}: cannot be written; the next run chooses again", file_of(question).string());
}

std::string program_version() {
    const auto built = environment();
    return fmt::format("{}{} kernels {}", built.commit, built.dirty ? " changed" : "",
                       hex(kernel_sources_digest()));
}

} // namespace tandem
