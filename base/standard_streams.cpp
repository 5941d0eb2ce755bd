// SPDX-License-Identifier: MIT
#include "base/standard_streams.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace tandem {

namespace {

/// errno of the first write to standard output that failed; 0: none.
int output_error = 0;
bool is_silent = false;

void do_nothing(int) {}

/// Makes a write fail with an error where it would raise the signal. Installs a handler: child processes
/// inherit an ignored signal, but not a handler.
void turn_into_error(int signal) {
    struct sigaction action {};
    action.sa_handler = do_nothing;
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
}

/// The escape at the beginning of a text that selects a colour: "\\033[1;32m"; empty if there is none.
std::string_view colour_at(std::string_view text) {
    if (!text.starts_with("\033[")) return {};
    const auto end = text.find_first_not_of("0123456789;", 2);
    return end != text.npos && text[end] == 'm' ? text.substr(0, end + 1) : std::string_view{};
}

} // namespace

void prepare_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(stream, F_GETFD) >= 0) continue;
        // open() returns the lowest free number, which is `stream`. Standard output is opened read-only, so
        // that writing to it fails as if it were closed. Messages to a closed standard error are discarded.
        (void)open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
    }
    for (const int signal : {SIGPIPE, SIGXFSZ}) turn_into_error(signal);
}

bool prints_colour() {
    const char* no_color = std::getenv("NO_COLOR");
    return isatty(STDOUT_FILENO) != 0 && (no_color == nullptr || *no_color == '\0');
}

std::size_t terminal_columns(int descriptor) {
    winsize size{};
    return ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

std::size_t output_columns(std::size_t usual) {
    constexpr std::size_t least = 40, most = 1000;
    auto columns = terminal_columns(STDOUT_FILENO);
    if (const std::string_view given = std::getenv("COLUMNS") != nullptr ? std::getenv("COLUMNS") : "";
        columns == 0)
        std::from_chars(given.data(), given.data() + given.size(), columns);
    return columns == 0 ? usual : std::clamp(columns, least, most);
}

void put_bytes(std::string_view bytes) {
    if (output_error != 0 || is_silent) return;
    if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size()) output_error = errno;
}

void put_text(std::string_view text) {
    std::string shown;
    while (!text.empty()) {
        const auto end = std::min(text.find("\033["), text.size());
        const auto colour = colour_at(text.substr(end));
        shown += visible(text.substr(0, end), "\n\t");
        // An escape that is no colour is visible, too.
        shown += colour.empty() ? visible(text.substr(end, 1)) : std::string(colour);
        text.remove_prefix(std::min(end + std::max<std::size_t>(colour.size(), 1), text.size()));
    }
    put_bytes(shown);
}

void print_message_text(std::string_view text) {
    if (!is_silent) print_message_text_from_every_rank(text);
}

void silence_streams() { is_silent = true; }

void print_message_text_from_every_rank(std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
}

bool flush_output() {
    if (std::fflush(stdout) != 0 && output_error == 0) output_error = errno;
    return output_error == 0;
}

int finish_output(int code) {
    // The reader of a pipe that is closed has all that it wanted, as in "tandem run ... | head".
    if (flush_output() || output_error == EPIPE) return code;
    print_message("tandem: standard output could not be written ({})\n", std::strerror(output_error));
    return 3;
}

} // namespace tandem
