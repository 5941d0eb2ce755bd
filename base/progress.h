// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <optional>
#include <string_view>

namespace tandem {

/// One line on standard error that is overwritten in place: "[42 %, 1:05, 1:30 left] text". The percentage is
/// that of the time. Prints nothing when standard error is no terminal.
class Progress {
public:
    /// The elapsed time counts from here.
    explicit Progress(bool quiet);
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

    bool on_;
    std::chrono::steady_clock::time_point begin_;
};

/// "[42 %, 1:05, 1:30 left]", or "[1:05]" without the second number.
std::string progress_text(double elapsed, std::optional<double> left);

} // namespace tandem
