// SPDX-License-Identifier: MIT
#include "harness/record/torn_line.h"

#include "harness/commands/standard_streams.h"
#include "base/durable.h"
#include "base/error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>

namespace tandem {

namespace {

constexpr std::size_t block_bytes = 1 << 16;
/// Longer ones are not what was to be a record.
constexpr std::size_t most_zeros = 1 << 24;

[[noreturn]] void fail_torn(const std::string& path, std::string_view what) {
    throw OutputError(fmt::format("{}: {} ({})", path, what, std::strerror(errno)));
}

/// As many of `bytes` bytes from `at` as the file has.
std::string read_part(int file, const std::string& path, std::size_t at, std::size_t bytes) {
    std::string text(bytes, '\0');
    std::size_t got = 0;
    while (got < bytes) {
        const auto n = pread(file, text.data() + got, bytes - got, static_cast<off_t>(at + got));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail_torn(path, "cannot be read");
        if (n == 0) break;
        got += static_cast<std::size_t>(n);
    }
    text.resize(got);
    return text;
}

enum class Text { object, beginning_of_one, other };

/// What a loss of power has left may be as long as what was written and have zeros in its place.
Text kind_of(std::string_view text) {
    const auto last = text.find_last_not_of('\0');
    if (last == std::string_view::npos) return text.empty() ? Text::other : Text::beginning_of_one;
    const bool torn = last + 1 < text.size();
    text = text.substr(0, last + 1);
    if (text.front() != '{') return Text::other;
    try {
        const bool is_object = nlohmann::json::parse(text).is_object();
        return !is_object ? Text::other : torn ? Text::beginning_of_one : Text::object;
    } catch (const nlohmann::json::parse_error& error) {
        // One byte further than there are: only the end is wrong with it.
        return error.byte > text.size() ? Text::beginning_of_one : Text::other;
    } catch (const nlohmann::json::exception&) { // a number that is too large
        return Text::other;
    }
}

/// Where the last line begins, of a file of `size` bytes.
std::size_t last_line(int file, const std::string& path, std::size_t size) {
    for (auto end = size; end > 0;) {
        const auto begin = end - std::min(end, block_bytes);
        const auto found = read_part(file, path, begin, end - begin).rfind('\n');
        if (found != std::string::npos) return begin + found + 1;
        end = begin;
    }
    return 0;
}

void write_torn(int file, const std::string& path, std::string_view text) {
    while (!text.empty()) {
        const auto n = write(file, text.data(), text.size());
        if (n < 0 && errno != EINTR) fail_torn(path, "writing failed");
        if (n > 0) text.remove_prefix(static_cast<std::size_t>(n));
    }
}

/// Adds a line to a file beside the records. Not through links: the name follows from that of the records,
/// and whoever may make files there must not choose what is written to.
void set_aside(const std::string& path, std::string_view line) {
    const int file =
        open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644);
    if (file < 0) fail_torn(path, "cannot be written, and a torn line has to go there");
    try {
        struct stat facts {};
        if (fstat(file, &facts) != 0 || !S_ISREG(facts.st_mode))
            throw OutputError(fmt::format("{}: is no file, and a torn line has to go there", path));
        write_torn(file, path, std::string(line) + "\n");
        if (fsync(file) != 0 && errno != EINVAL && errno != ENOTSUP) fail_torn(path, "writing failed");
        sync_folder_of(path);
    } catch (...) {
        close(file);
        throw;
    }
    close(file);
}

} // namespace

std::size_t size_of(int file, const std::string& path) {
    struct stat facts {};
    if (fstat(file, &facts) != 0) fail_torn(path, "cannot be read");
    return static_cast<std::size_t>(facts.st_size);
}

bool read_line(int file, const std::string& path, std::size_t at, std::string& line) {
    line.clear();
    while (true) {
        const auto part = read_part(file, path, at + line.size(), block_bytes);
        const auto end = part.find('\n');
        line.append(part, 0, end);
        if (end != std::string::npos) return true;
        if (part.size() < block_bytes) return !line.empty();
    }
}

void check_first_line(int file, const std::string& path) {
    const auto size = size_of(file, path);
    // What does not begin as an object need not be read to the end of its first line.
    if (size == 0) return;
    std::string line;
    if (const auto first = read_part(file, path, 0, 1);
        first == "{" || (first[0] == '\0' && size <= most_zeros))
        read_line(file, path, 0, line);
    const auto kind = kind_of(line);
    if (kind == Text::object || (kind == Text::beginning_of_one && line.size() == size)) return;
    throw InputError(fmt::format("{}: its first line is no JSON object, so records do not go there; choose "
                                 "another --out",
                                 path));
}

void mend_last_line(int file, const std::string& path) {
    const auto size = size_of(file, path);
    if (size == 0 || read_part(file, path, size - 1, 1) == "\n") return;
    const auto begin = last_line(file, path, size);
    const auto line = read_part(file, path, begin, size - begin);
    if (kind_of(line) == Text::object) {
        write_torn(file, path, "\n");
        return;
    }
    const auto beside = path + ".torn";
    set_aside(beside, line);
    if (ftruncate(file, static_cast<off_t>(begin)) != 0)
        fail_torn(path, "its torn last line cannot be taken off");
    print_message("tandem: {}: the last line was torn; its {} bytes are set aside in {}\n", path, line.size(),
                  beside);
}

} // namespace tandem
