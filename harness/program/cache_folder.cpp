// SPDX-License-Identifier: MIT
#include "harness/program/cache_folder.h"

#include "base/error.h"
#include "base/private_folder.h"
#include "base/standard_streams.h"
#include "base/text_lines.h"

#include <cstdlib>
#include <fmt/format.h>

namespace tandem {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view variable = "TANDEM_KERNEL_CACHE";

/// An absolute path of an environment variable; empty without one.
fs::path path_in(const char* name) {
    const auto* text = std::getenv(name);
    return text == nullptr || *text != '/' ? fs::path() : fs::path(text);
}

fs::path usual_folder() {
    if (const auto cache = path_in("XDG_CACHE_HOME"); !cache.empty()) return cache / "tandem";
    if (const auto home = path_in("HOME"); !home.empty()) return home / ".cache/tandem";
    return {};
}

/// A folder that only this user can write to, if it can be written.
CacheFolder tried(const fs::path& folder, const std::string& name, std::string_view advice) {
    make_own(folder);
    const auto why = why_not_writable(folder);
    if (why.empty()) return {.path = folder, .problem = {}};
    return {.path = {},
            .problem = fmt::format("{}{} cannot be written ({}), so that nothing is stored in it; {}", name,
                                   visible(folder.string()), why, advice)};
}

} // namespace

CacheFolder find_cache_folder() {
    if (const auto* given = std::getenv(variable.data()); given != nullptr && *given != 0) {
        if (const auto why = why_not_own(given); !why.empty())
            return {.path = {}, .problem = fmt::format("{}: {}", variable, why), .is_refused = true};
        return tried(given, fmt::format("{}: ", variable), "name another folder");
    }
    const auto folder = usual_folder();
    if (folder.empty() || !why_not_own(folder).empty()) return {};
    return tried(folder, "", fmt::format("name another folder in {}", variable));
}

fs::path cache_folder() {
    auto found = find_cache_folder();
    if (found.is_refused) throw InputError(found.problem);
    return found.path;
}

void report_cache_folder() {
    static bool is_reported = false;
    if (is_reported) return;
    is_reported = true;
    const auto found = find_cache_folder();
    if (found.is_refused) throw InputError(found.problem);
    if (!found.problem.empty()) print_message("tandem: {}\n", found.problem);
}

} // namespace tandem
