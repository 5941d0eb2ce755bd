// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace tandem {

/// Stores values that are expensive to compute and equal in every run of this program, in a JSON-lines file.
/// The key of a value is the text of a question. Processes may share a file. Torn lines are ignored, and a
/// failed write has no effect: no function throws for them.
class VerificationCache {
public:
    /// Stores nothing.
    VerificationCache() = default;
    /// Uses one file in the folder for each `subject` and version of the sources. With an empty folder
    /// nothing is stored.
    VerificationCache(const std::filesystem::path& folder, const std::string& subject);

    /// Passes the stored value to `read`. Returns false when there is none, or when `read` rejects it by
    /// throwing nlohmann::json::exception.
    bool take(const std::string& question, const std::function<void(const nlohmann::json&)>& read) const;
    /// Stores a value in the file and in memory.
    void keep(const std::string& question, nlohmann::json value);

private:
    std::filesystem::path file_;
    std::map<std::string, nlohmann::json> values_;
};

} // namespace tandem
