// SPDX-License-Identifier: MIT
// Settings of leaf queries.
#pragma once

#include "algorithms/parameters/table.h"

namespace tandem {

/// What a tree of leaf queries covers.
enum class QueriedTree {
    body, ///< the tetrahedra of one body; the queries of a body pair are those of its smaller body
    scene ///< the tetrahedra of all bodies; each of them queries it
};

namespace leaf_query_parameters {
inline constexpr auto tree =
    Setting<QueriedTree>{
        "tree",
        QueriedTree::body,
        {{"body", QueriedTree::body}, {"scene", QueriedTree::scene}},
        "",
        "trees that leaves query: body: one per body, which the tetrahedra of the smaller body of each body "
        "pair query; scene: one over the tetrahedra of all bodies, built on the device along the Z-curve, "
        "which each of them queries for those behind it"}
        .with_alternatives({QueriedTree::body, QueriedTree::scene});
inline constexpr Setting<std::int64_t> rebuild{"rebuild", 8, ValueRange{1, parameters::word_limit}, "",
                                               "tree=scene: frames from one build of the tree to the next, "
                                               "1: in every frame; bounds follow every frame, "
                                               "so that an old tree costs time but no pairs"};
} // namespace leaf_query_parameters

} // namespace tandem
