// SPDX-License-Identifier: MIT
#pragma once

#include "harness/report/records.h"

namespace tandem::report {

/// The records of a page.
struct PageData {
    std::string json;
    std::size_t cells = 0;          ///< that are shown
    std::vector<std::string> notes; ///< what was left out
};

/// What a page is made of, as JSON text of about `most_bytes` at most: cells with their groups and words,
/// profiles, ceilings, simulations. What there is no room for is left out: curves and rounds first, then
/// cells, the last first; its notes say so.
PageData data_of(Records records, std::size_t most_bytes);

} // namespace tandem::report
