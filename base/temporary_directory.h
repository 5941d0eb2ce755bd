// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// A private folder among the temporary files; the destructor removes it with its contents.
class TemporaryDirectory {
public:
    /// Throws InputError when it cannot create the folder.
    TemporaryDirectory();
    ~TemporaryDirectory();
    TemporaryDirectory(const TemporaryDirectory&) = delete;
    TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

    const std::string& path() const { return path_; }

private:
    std::string path_;
};

} // namespace tandem
