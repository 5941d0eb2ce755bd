// SPDX-License-Identifier: MIT
#pragma once

#include "harness/compare/cells.h"

#include <span>

namespace tandem::compare {

/// Short names of cells: what differs among them, and nothing else.
struct Labels {
    std::vector<std::string> of; ///< one a cell, in order; no two are equal where keys are not
    std::string common;          ///< what all share: "chunked, cuda:0, NVIDIA H200, ..."
};

/// Of a cell's names each that tells apart cells which those before it do not, then so of its settings (and
/// the parameters of its scene) by the alphabet: what differs along with one that is shown stays unsaid.
Labels label(std::span<const RecordedCell* const> cells);

} // namespace tandem::compare
