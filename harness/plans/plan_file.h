// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"

namespace tandem {

/// A product scenes x frames x request: cells, before any device is opened.
struct Product {
    std::vector<std::string> scenes; ///< as on the command line
    std::vector<std::string> frames; ///< "FIRST:LAST" or "N"; empty: all of the scene
    Request request;
};

/// Excludes the cells that match every field of `product` that is not empty.
struct Exclusion {
    Product product;
    std::string location;      ///< in the file, for messages
    bool may_be_empty = false; ///< may match no cell, because options replaced fields of the plan
};

/// A plan, as in a file of results/plan.schema.json.
struct PlanFile {
    std::string name; ///< the value of "plan"
    std::vector<Product> products;
    std::vector<Exclusion> exclusions;
    bool skips_impossible = false; ///< skips cells that do not fit a device, a scene or themselves
    /// Options of `tandem run`: names without dashes, and values; "" for flags.
    std::vector<std::pair<std::string, std::string>> measure;
};

/// Whether the path is a JSON file with "plan" at the top level; false when it cannot be read.
bool is_plan(const std::string& path);

/// Reads a plan. Paths of scene files are relative to the plan. Throws InputError that names the location:
/// invalid JSON, unknown fields, values of wrong types, empty lists, ranges that never end.
PlanFile read_plan(const std::string& path);

} // namespace tandem
