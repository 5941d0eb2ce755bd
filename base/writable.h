// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace tandem {

/// Why no file can be made in `folder`, as the system words it; empty when one can. Creates a missing folder,
/// as the library whose cache it is does, and removes its own trial file.
std::string why_not_writable(const std::filesystem::path& folder);

} // namespace tandem
