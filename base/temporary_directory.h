// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// A folder of this process alone among the temporary files, which goes again with all that is in it.
class PassingFolder {
public:
    /// Throws InputError where none can be made.
    PassingFolder();
    ~PassingFolder();
    PassingFolder(const PassingFolder&) = delete;
    PassingFolder& operator=(const PassingFolder&) = delete;

    const std::string& path() const { return path_; }

private:
    std::string path_;
};

} // namespace tandem
