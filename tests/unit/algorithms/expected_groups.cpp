// SPDX-License-Identifier: MIT
#include "algorithms/kernels/expected_groups.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

TEST(ExpectedGroups, SufficeForTwiceTheWork) {
    EXPECT_EQ(ExpectedGroups().groups_for(0, 2112), 2u);
    EXPECT_EQ(ExpectedGroups().groups_for(1, 2112), 2u);
    EXPECT_EQ(ExpectedGroups().groups_for(3, 2112), 8u);
    EXPECT_EQ(ExpectedGroups().groups_for(300, 2112), 1024u);
    EXPECT_EQ(ExpectedGroups().groups_for(1000, 2112), 2048u);
    EXPECT_EQ(ExpectedGroups().groups_for(2000, 2112), 2112u);
    EXPECT_EQ(ExpectedGroups().groups_for(1ull << 40, 2112), 2112u);
    EXPECT_EQ(ExpectedGroups().groups_for(5, 1), 1u);
}

TEST(ExpectedGroups, ChangeRarely) {
    ExpectedGroups groups;
    EXPECT_EQ(groups.groups_for(100, 2112), 256u);
    for (const std::uint64_t wanted : {256, 130, 99, 32}) EXPECT_EQ(groups.groups_for(wanted, 2112), 256u);
    EXPECT_EQ(groups.groups_for(31, 2112), 64u); // an eighth
    EXPECT_EQ(groups.groups_for(65, 2112), 256u);
}

} // namespace
} // namespace tandem
