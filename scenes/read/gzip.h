// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace tandem::read {

/// Whether the bytes begin as a gzip file.
bool is_gzip(std::string_view bytes);

/// The content of a gzip file, of one or more members. Throws InputError that names `source`.
std::string gunzipped(std::string_view bytes, const std::string& source);

} // namespace tandem::read
