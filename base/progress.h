// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <optional>
#include <string_view>

namespace tandem {

/// Lines on standard error: "[42 %, 1:05, 1:30 left] text". The percentage is that of the time. In a terminal
/// it is one line that is overwritten in place; elsewhere, such as in a log, a line every `period` seconds.
class Progress {
public:
    /// The elapsed time counts from here. `quiet`: prints nothing.
    explicit Progress(bool quiet, double period = 10);
    ~Progress() { clear(); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// `left`: estimated seconds to the end; none when they are not known yet.
    void show(std::string_view text, std::optional<double> left = {}) const;
    void clear() const;
    /// Seconds to the end of work of which this fraction is done since the construction; none for 0.
    std::optional<double> left(double fraction) const;

private:
    double elapsed() const;

    bool on_, in_place_;
    double period_;
    mutable double shown_ = 0; ///< the elapsed seconds at the last line of a log
    std::chrono::steady_clock::time_point begin_;
};

/// "[42 %, 1:05, 1:30 left]", or "[1:05]" without the second number.
std::string progress_text(double elapsed, std::optional<double> left);

} // namespace tandem
