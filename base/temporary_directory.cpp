// SPDX-License-Identifier: MIT
#include "base/temporary_directory.h"

#include "base/error.h"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

namespace tandem {

TemporaryDirectory::TemporaryDirectory() {
    std::error_code error;
    const auto folder = std::filesystem::temp_directory_path(error);
    if (error) throw InputError("there is no folder for temporary files; set TMPDIR to one");
    path_ = (folder / "tandem-XXXXXX").string();
    if (mkdtemp(path_.data()) == nullptr)
        throw InputError(fmt::format("{}: cannot be created; set TMPDIR to a writable folder", path_));
}

TemporaryDirectory::~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

} // namespace tandem
