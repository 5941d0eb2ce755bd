// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// Makes the name of a file last that was made or renamed: a synced file has its name for certain only when
/// the folder is synced as well. Folders that cannot be synced, or not by this user, are left. Throws
/// OutputError when the disk fails.
void sync_folder_of(const std::string& path);

} // namespace tandem
