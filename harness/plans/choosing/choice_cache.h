// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/choosing/choice.h"

#include <filesystem>

namespace tandem {

/// Everything that a choice depends on, as JSON. Devices: models, drivers, memory limits. Scene: numbers of
/// bodies, tetrahedra and `pairs` (candidate pairs a frame) as powers of 4 rounded down (null: none), and
/// whether bodies are deformable. Candidates: a digest of all, which includes the settings that the user
/// fixed.
nlohmann::ordered_json question_of(const Cell& cell, const Scene& scene, std::uint64_t pairs);

/// Stores choices in JSON files, one for each question, across processes. Processes may share a folder.
class ChoiceCache {
public:
    /// `program` identifies this build: choices of other builds are ignored. With an empty folder nothing is
    /// stored.
    ChoiceCache(std::filesystem::path folder, std::string program)
        : folder_(std::move(folder)), program_(std::move(program)) {}

    std::filesystem::path file_of(const nlohmann::ordered_json& question) const;
    /// The stored choice; none when there is none of this program. `warning` receives one line when the file
    /// cannot be used, else it is empty.
    std::optional<Choice> find(const nlohmann::ordered_json& question, std::string& warning) const;
    /// Stores a choice and replaces an earlier one. Returns an error message of one line; empty on success.
    std::string keep(const nlohmann::ordered_json& question, const Choice& choice) const;

private:
    std::filesystem::path folder_;
    std::string program_;
};

/// The commit and the kernels of this program.
std::string program_version();

} // namespace tandem
