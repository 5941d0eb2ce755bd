// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace tandem {

/// Values that take long to find and are the same in every run of this program: kept in a file of lines, by
/// the text of a question. Processes may share a file; a line that is torn, or of another program, is as if
/// it were not there, and a value that cannot be kept is not: nothing fails.
class VerificationCache {
public:
    /// Keeps nothing.
    VerificationCache() = default;
    /// One file in the folder for each `subject`, which is part of every question; an empty folder keeps
    /// nothing.
    VerificationCache(const std::filesystem::path& folder, const std::string& subject);

    /// Hands over what is kept; false when nothing is, or `read` finds (nlohmann::json::exception) that it is
    /// no such value.
    bool take(const std::string& question, const std::function<void(const nlohmann::json&)>& read) const;
    void keep(const std::string& question, nlohmann::json value);

private:
    std::filesystem::path file_;
    std::map<std::string, nlohmann::json> values_;
};

} // namespace tandem
