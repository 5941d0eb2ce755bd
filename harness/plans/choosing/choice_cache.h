// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/choosing/choice.h"

#include <filesystem>

namespace tandem {

/// What a choice depends on, as JSON: the devices' models, drivers and limits of memory; the class of the
/// scene, bodies, tetrahedra and `pairs`, candidate pairs a frame, each as a power of 4 rounded down (null:
/// none), and whether bodies are deformable; a digest of all candidates and so of what the user fixed.
nlohmann::ordered_json question_of(const Cell& cell, const Scene& scene, std::uint64_t pairs);

/// Choices kept in JSON files, one a question, from one process to the next. Processes may share a folder.
class ChoiceCache {
public:
    /// $TANDEM_KERNEL_CACHE, else $XDG_CACHE_HOME/tandem, else ~/.cache/tandem; empty, which keeps nothing,
    /// where none of these is there or others can write to it; throws InputError where that is so of the
    /// first.
    static std::filesystem::path default_folder();

    /// `program`: what a choice goes out of date with. An empty folder keeps nothing.
    ChoiceCache(std::filesystem::path folder, std::string program)
        : folder_(std::move(folder)), program_(std::move(program)) {}

    std::filesystem::path file_of(const nlohmann::ordered_json& question) const;
    /// None when there is none, or one of another program. `warning`: why a file cannot be used, one line;
    /// empty otherwise.
    std::optional<Choice> find(const nlohmann::ordered_json& question, std::string& warning) const;
    /// Replaces what was there. Returns why it could not be kept, one line; empty when it was.
    std::string keep(const nlohmann::ordered_json& question, const Choice& choice) const;

private:
    std::filesystem::path folder_;
    std::string program_;
};

/// The commit and the kernels of this program.
std::string program_version();

} // namespace tandem
