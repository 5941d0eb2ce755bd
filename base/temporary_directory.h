// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// A folder of this process alone among the temporary files, which goes again with all that is in it.
class TemporaryDirectory {
public:
    /// Throws InputError where none can be made.
    TemporaryDirectory();
    ~TemporaryDirectory();
    TemporaryDirectory(const TemporaryDirectory&) = delete;
    TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

    const std::string& path() const { return path_; }

private:
    std::string path_;
};

} // namespace tandem
