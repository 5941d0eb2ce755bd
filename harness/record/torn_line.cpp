// SPDX-License-Identifier: MIT
#include "harness/record/torn_line.h"

#include "base/standard_streams.h"
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
/// A longer run of zeros cannot be a torn record.
constexpr std::size_t most_zeros = 1 << 24;

[[noreturn]] void fail_torn(const std::string& path, std::string_view what) {
    throw OutputError(fmt::format("{}: {} ({})", path, what, std::strerror(errno)));
}

/// Reads at most `bytes` bytes from offset `at`; fewer at the end of the file.
std::string read_part(int file, const std::string& path, std::size_t at, std::size_t bytes) {
    std::string text(bytes, '\0');
    std::size_t done = 0;
    while (done < bytes) {
        const auto n = pread(file, text.data() + done, bytes - done, static_cast<off_t>(at + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail_torn(path, "cannot be read");
        if (n == 0) break;
        done += static_cast<std::size_t>(n);
    }
    text.resize(done);
    return text;
}

enum class Text { object, partial_object, other };

/// A power loss can leave a line of full length with zeros in place of its text.
Text kind_of(std::string_view text) {
    const auto last = text.find_last_not_of('\0');
    if (last == std::string_view::npos) return text.empty() ? Text::other : Text::partial_object;
    const bool torn = last + 1 < text.size();
    text = text.substr(0, last + 1);
    if (text.front() != '{') return Text::other;
    try {
        const bool is_object = nlohmann::json::parse(text).is_object();
        return !is_object ? Text::other : torn ? Text::partial_object : Text::object;
    } catch (const nlohmann::json::parse_error& error) {
        // The parser failed behind the last byte, so that only the end is missing.
        return error.byte > text.size() ? Text::partial_object : Text::other;
    } catch (const nlohmann::json::exception&) { // for example a number that is too large
        return Text::other;
    }
}

/// Offset of the last line in a file of `size` bytes.
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

/// Appends a line to a file beside the records. Refuses links: the file's name is predictable, and a user who
/// can create files in that folder must not redirect the write.
void append_torn_line(const std::string& path, std::string_view line) {
    const int file =
        open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644);
    if (file < 0) fail_torn(path, "cannot be written, but a torn line must be moved to it");
    try {
        struct stat facts {};
        if (fstat(file, &facts) != 0 || !S_ISREG(facts.st_mode))
            throw OutputError(
                fmt::format("{}: is not a regular file, but a torn line must be moved to it", path));
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
    // Read the first line only if it can be an object; it may be very long in another file.
    if (size == 0) return;
    std::string line;
    if (const auto first = read_part(file, path, 0, 1);
        first == "{" || (first[0] == '\0' && size <= most_zeros))
        read_line(file, path, 0, line);
    const auto kind = kind_of(line);
    if (kind == Text::object || (kind == Text::partial_object && line.size() == size)) return;
    throw InputError(
        fmt::format("{}: its first line is not a JSON object, so no records are appended; choose "
                    "another --out",
                    path));
}

void repair_last_line(int file, const std::string& path) {
    const auto size = size_of(file, path);
    if (size == 0 || read_part(file, path, size - 1, 1) == "\n") return;
    const auto begin = last_line(file, path, size);
    const auto line = read_part(file, path, begin, size - begin);
    if (kind_of(line) == Text::object) {
        write_torn(file, path, "\n");
        return;
    }
    const auto torn_path = path + ".torn";
    append_torn_line(torn_path, line);
    if (ftruncate(file, static_cast<off_t>(begin)) != 0)
        fail_torn(path, "its torn last line cannot be removed");
    print_message("tandem: {}: the last line was torn; its {} bytes were moved to {}\n", path, line.size(),
                  torn_path);
}

} // namespace tandem
