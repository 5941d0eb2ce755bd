// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem::report {

/// What `tandem compare OLD NEW` says of two files, for the page to draw: JSON text. Throws InputError as it
/// does.
std::string differences(const std::string& before, const std::string& after);

} // namespace tandem::report
