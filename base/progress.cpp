// SPDX-License-Identifier: MIT
#include "base/progress.h"

#include "base/standard_streams.h"
#include "base/text_lines.h"

#include <cmath>
#include <fmt/format.h>
#include <unistd.h>

namespace tandem {

namespace {

constexpr std::size_t usual_columns = 80; ///< of a terminal that does not report its size

/// "0:07", "12:30" or "3:00:00".
std::string clock_text(double seconds) {
    const auto whole = static_cast<std::int64_t>(std::llround(seconds));
    const auto minutes = whole / 60;
    return minutes < 60 ? fmt::format("{}:{:02}", minutes, whole % 60)
                        : fmt::format("{}:{:02}:{:02}", minutes / 60, minutes % 60, whole % 60);
}

} // namespace

std::string progress_text(double elapsed, std::optional<double> left) {
    if (!left) return fmt::format("[{}]", clock_text(elapsed));
    const auto whole = elapsed + *left;
    const auto percent = whole > 0 ? std::floor(100 * elapsed / whole) : 100.0;
    return fmt::format("[{} %, {}, {} left]", percent, clock_text(elapsed), clock_text(*left));
}

Progress::Progress(bool quiet, double period)
    : on_(!quiet),
      in_place_(isatty(STDERR_FILENO) != 0),
      period_(period),
      begin_(std::chrono::steady_clock::now()) {}

double Progress::elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

std::optional<double> Progress::left(double fraction) const {
    if (fraction <= 0) return std::nullopt;
    return elapsed() * (1 - fraction) / fraction;
}

/// A line that is longer than the terminal could not be overwritten.
void Progress::show(std::string_view text, std::optional<double> left) const {
    if (!on_) return;
    if (!in_place_) {
        const auto now = elapsed();
        if (now - shown_ < period_) return;
        shown_ = now;
        print_message("{} {}\n", progress_text(now, left), text);
        return;
    }
    const auto columns = terminal_columns(STDERR_FILENO);
    const auto line = fmt::format("{} {}", progress_text(elapsed(), left), text);
    print_message("\r\033[K{}", shortened(line, (columns > 0 ? columns : usual_columns) - 1));
}

void Progress::clear() const {
    if (on_ && in_place_) print_message("\r\033[K");
}

} // namespace tandem
