// SPDX-License-Identifier: MIT
#include "base/temporary_directory.h"

#include "base/error.h"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

namespace tandem {

TemporaryDirectory::TemporaryDirectory() {
    std::error_code none;
    const auto folder = std::filesystem::temp_directory_path(none);
    if (none) throw InputError("there is no folder for temporary files; set TMPDIR to one");
    path_ = (folder / "tandem-XXXXXX").string();
    if (mkdtemp(path_.data()) == nullptr)
        throw InputError(fmt::format("{}: cannot be made; set TMPDIR", path_));
}

TemporaryDirectory::~TemporaryDirectory() {
    std::error_code none;
    std::filesystem::remove_all(path_, none);
}

} // namespace tandem
