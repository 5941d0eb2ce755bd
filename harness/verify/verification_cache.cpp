// SPDX-License-Identifier: MIT
#include "harness/verify/verification_cache.h"

#include "base/private_folder.h"
#include "harness/program/environment.h"
#include "base/digest.h"

#include <fmt/format.h>
#include <fstream>

namespace tandem {

/// The digest of the sources is part of the file name, because another version may compute other values.
VerificationCache::VerificationCache(const std::filesystem::path& folder, const std::string& subject) {
    if (folder.empty()) return;
    const auto digest = digest_of(sources_digest() + "|" + subject);
    file_ = folder / fmt::format("checks-{:016x}.jsonl", digest);
    std::ifstream lines(file_);
    for (std::string line; std::getline(lines, line);) {
        const auto entry = nlohmann::json::parse(line, nullptr, false);
        if (entry.is_object() && entry.contains("question") && entry["question"].is_string()
            && entry.contains("value"))
            values_[entry["question"].get<std::string>()] = entry["value"];
    }
}

bool VerificationCache::take(const std::string& question,
                             const std::function<void(const nlohmann::json&)>& read) const {
    const auto found = values_.find(question);
    if (found == values_.end()) return false;
    try {
        read(found->second);
        return true;
    } catch (const nlohmann::json::exception&) {
        return false;
    }
}

/// Writes a newline first, because the previous line may be torn.
void VerificationCache::keep(const std::string& question, nlohmann::json value) {
    if (file_.empty()) return;
    make_own(file_.parent_path());
    std::ofstream(file_, std::ios::app)
        << "\n" + nlohmann::json{{"question", question}, {"value", value}}.dump() + "\n";
    values_[question] = std::move(value);
}

} // namespace tandem
