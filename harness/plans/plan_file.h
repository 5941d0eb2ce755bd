// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"

namespace tandem {

/// scenes x frames x what a request names: cells, before any device is looked at.
struct Product {
    std::vector<std::string> scenes; ///< as on the command line
    std::vector<std::string> frames; ///< "FIRST:LAST" or "N"; empty: all of the scene
    Request request;
};

/// Cells that are not wanted: those that match every field of `product` that is not empty.
struct Exclusion {
    Product product;
    std::string place;         ///< in the file, for messages
    bool may_be_empty = false; ///< it may match no cell: the plan's own were replaced
};

/// What is measured, as a file of results/plan.schema.json says it.
struct PlanFile {
    std::string name; ///< what stands behind "plan"
    std::vector<Product> products;
    std::vector<Exclusion> exclusions;
    bool skips_impossible = false; ///< instead of refusing what fits no device, scene or not itself
    /// Options of `tandem run` under their names without dashes, and their values; "" of flags.
    std::vector<std::pair<std::string, std::string>> measure;
};

/// Whether the path is that of a JSON file whose top level has a "plan"; false where it cannot be read.
bool is_plan(const std::string& path);

/// Scenes that are files are found relative to the plan. Throws InputError that names the place: what is no
/// JSON, unknown fields, values of other types, empty lists, ranges that never end.
PlanFile read_plan(const std::string& path);

} // namespace tandem
