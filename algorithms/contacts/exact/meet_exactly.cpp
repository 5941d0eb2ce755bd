// SPDX-License-Identifier: MIT
#include "algorithms/contacts/exact/meet_exactly.h"

#include "algorithms/contacts/exact/decision.h"

namespace tandem {

bool meet_exactly(const TetraCorners& a, const TetraCorners& b) {
    return relation(a, b) != Relation::disjoint;
}

} // namespace tandem
