// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace tandem {

/// CITATION.bib: BibTeX entries of tandem and of the papers whose methods it hosts.
std::string_view citation();

} // namespace tandem
