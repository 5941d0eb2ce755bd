// SPDX-License-Identifier: MIT
#include "base/read_json.h"

#include "base/error.h"
#include "base/files_in_use.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

namespace tandem {

namespace {

using Json = nlohmann::json;

/// An error found before the whole file is parsed; thrown through the parser.
struct Refusal {
    std::string what;
};

/// Parser callback that refuses repeated names in one object and deep nesting.
class Names {
public:
    bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
        const auto at = static_cast<std::size_t>(depth);
        if (at > max_json_depth)
            throw Refusal{fmt::format("is nested deeper than {} levels; reduce the nesting", max_json_depth)};
        if (event == Json::parse_event_t::object_start) {
            open_.resize(std::max(open_.size(), at + 1));
            open_[at].clear();
        }
        // A name belongs to the object that begins one level above.
        if (event == Json::parse_event_t::key && !open_.at(at - 1).insert(parsed.get<std::string>()).second)
            throw Refusal{fmt::format("has the name {} twice in one object; leave one out",
                                      parsed.dump(-1, ' ', true, Json::error_handler_t::replace))};
        return true;
    }

private:
    std::vector<std::set<std::string>> open_; ///< names of each open object, by depth
};

std::string text_of(const std::string& path, std::string_view what) {
    std::ifstream file(path, std::ios::binary);
    if (!file || std::filesystem::is_directory(path))
        throw InputError(fmt::format("{}: cannot be read; name an existing {}", path, what));
    note_input(path);
    std::string text;
    std::vector<char> part(std::size_t{1} << 16);
    while (file.read(part.data(), static_cast<std::streamsize>(part.size())) || file.gcount() > 0) {
        text.append(part.data(), static_cast<std::size_t>(file.gcount()));
        if (text.size() > max_json_bytes)
            throw InputError(fmt::format("{}: is longer than the {} MiB that a {} may have", path,
                                         max_json_bytes >> 20, what));
    }
    return text;
}

} // namespace

Json read_json(const std::string& path, std::string_view what) {
    const auto text = text_of(path, what);
    try {
        return Json::parse(text, Names());
    } catch (const Refusal& refusal) {
        throw InputError(fmt::format("{}: {}", path, refusal.what));
    } catch (const Json::parse_error& error) {
        const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(error.byte, 1) - 1);
        throw InputError(fmt::format("{}:{}: not JSON; repair the {} around this line", path,
                                     1 + std::count(text.begin(), end, '\n'), what));
    } catch (const Json::out_of_range&) {
        throw InputError(
            fmt::format("{}: has a number that is too large for a double; write one below 1.8e308", path));
    }
}

} // namespace tandem
