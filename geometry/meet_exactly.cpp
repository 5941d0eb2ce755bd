// SPDX-License-Identifier: MIT
#include "geometry/meet_exactly.h"

#include "geometry/decision.h"

namespace tandem {

bool meet_exactly(const TetraCorners& a, const TetraCorners& b) {
    return relation(a, b) != Relation::disjoint;
}

} // namespace tandem
