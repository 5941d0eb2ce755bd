// SPDX-License-Identifier: MIT
#pragma once

#include "base/standard_streams.h"

#include <string_view>
#include <unistd.h>

namespace tandem {

/// One line on standard error that is overwritten in place. Prints nothing when that is no terminal.
class Progress {
public:
    explicit Progress(bool quiet) : on_(!quiet && isatty(STDERR_FILENO) != 0) {}
    ~Progress() { clear(); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(std::string_view text) const {
        if (on_) print_message("\r\033[K{}", text);
    }
    void clear() const { show(""); }

private:
    bool on_;
};

} // namespace tandem
