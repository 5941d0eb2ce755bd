// SPDX-License-Identifier: MIT
// Lists of the partners of each body, from body pairs in any order.
#include "algorithms/leaf_query/partner_lists.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using Words = std::vector<std::uint32_t>;

TEST(PartnerLists, HaveEachPairInBothListsAscending) {
    const std::vector<BodyPair> pairs{{2, 4}, {0, 4}, {1, 4}, {0, 2}};
    EXPECT_EQ(partner_lists(pairs, 5), (Words{6, 8, 9, 11, 11, 14, 2, 4, 4, 0, 4, 0, 1, 2}));
}

TEST(PartnerLists, HaveABodyThatMeetsItselfOnce) {
    const std::vector<BodyPair> pairs{{1, 1}, {0, 1}};
    EXPECT_EQ(partner_lists(pairs, 2), (Words{3, 4, 6, 1, 0, 1}));
}

TEST(PartnerLists, OfNoPairsAreEmpty) { EXPECT_EQ(partner_lists({}, 3), (Words{4, 4, 4, 4})); }

} // namespace
} // namespace tandem
