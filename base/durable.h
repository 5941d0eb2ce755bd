// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// Makes the name of a created or renamed file durable: syncing the file does not guarantee its name until
/// the folder is synced as well. Skips folders that cannot be synced or that this user cannot open. Throws
/// OutputError when the disk fails.
void sync_folder_of(const std::string& path);

} // namespace tandem
