// SPDX-License-Identifier: MIT
#pragma once

#include "harness/compare/ratio.h"
#include "harness/report/records.h"

namespace tandem::report {

/// A cell in the order of speed, held against the fastest of its group.
struct Place {
    std::size_t cell = 0;       ///< its number
    compare::Ratio ratio{};     ///< of its time to the fastest's; 1 of the fastest itself
    bool is_told_apart = false; ///< 1 lies outside the ratio's 95 % interval
    bool has_interval = false;  ///< both have rounds enough for one
};

/// Cells whose times may be divided, as of `tandem run`'s table: one scene and frames, devices, bounds and
/// output.
struct Group {
    std::string title;
    std::vector<std::size_t> cells{};  ///< all, in their order
    std::vector<std::string> labels{}; ///< of each: what differs among them
    std::vector<Place> ranked{};       ///< those that are right and newest, the fastest first
    bool answers_differ = false;       ///< of these; then none is said to be the fastest
};

/// Every cell is in one group.
std::vector<Group> groups_of(const std::vector<ShownCell>& cells);

/// What a group says, in sentences: who is the fastest, by how much, how sure; who failed or was wrong.
std::string words_of(const Group& group, const std::vector<ShownCell>& cells);

/// What all groups say together: how often which algorithm is the fastest, what takes no part.
std::vector<std::string> words_of(const std::vector<Group>& groups, const std::vector<ShownCell>& cells);

} // namespace tandem::report
