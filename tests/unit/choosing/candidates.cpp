// SPDX-License-Identifier: MIT
#include "harness/plans/candidates.h"

#include "base/error.h"
#include "harness/choosing/choose.h"
#include "scenes/scene.h"
#include "tests/support/cells.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>

namespace tandem {
namespace {

DeviceGroup on_host() { return {&support::device("host")}; }

std::vector<Cell> of(const SettingTexts& given, std::vector<std::string> presets = {}) {
    Request request;
    request.presets = std::move(presets);
    return candidates(request, given, on_host());
}

std::set<std::string> values_of(const std::vector<Cell>& cells, std::string_view algorithm,
                                std::string_view setting) {
    std::set<std::string> values;
    for (const auto& cell : cells)
        if (cell.algorithm->name() == algorithm) values.insert(cell.settings.text(setting));
    return values;
}

TEST(ChoosingCandidates, EveryAlgorithmWithEveryAlternative) {
    const auto cells = of({});
    for (std::size_t i = 0; i < algorithms().size(); ++i) { // unchanged presets first
        EXPECT_EQ(cells[i].algorithm, algorithms()[i]);
        EXPECT_EQ(cells[i].preset, algorithms()[i]->presets().front().name);
    }
    EXPECT_EQ(values_of(cells, "tiled", "slabs"), (std::set<std::string>{"usual", "all"}));
    for (const auto* traversal : algorithms())
        EXPECT_EQ(values_of(cells, traversal->name(), "builder"), (std::set<std::string>{"morton", "sah"}));
    std::set<std::string> different;
    for (const auto& cell : cells) different.insert(describe(cell));
    EXPECT_EQ(different.size(), cells.size());
}

/// The paper's presets use k = 8, all others 18: the first preset named decides.
TEST(ChoosingCandidates, HaveOneAnswer) {
    for (const auto& presets : {std::vector<std::string>{"all"}, {"published"}}) {
        const auto cells = of({}, presets);
        for (const auto& cell : cells) EXPECT_EQ(cell.settings.text("k"), cells.front().settings.text("k"));
    }
    EXPECT_EQ(of({}, {"published"}).front().settings.text("k"), "8");
}

/// k is an alternative where it changes no contact, and nowhere else.
TEST(ChoosingCandidates, DifferInKOnlyIfContactsAreEqualForEveryK) {
    const SettingTexts exact{{"output", "contacts"}, {"decision", "exact"}};
    const auto values = [&](const SettingTexts& given) {
        auto all = exact;
        for (const auto& [name, value] : given) all[name] = value;
        return values_of(of(all), "tiled", "k");
    };
    using Values = std::set<std::string>;
    EXPECT_EQ(values({}), (Values{"6", "18"}));
    EXPECT_EQ(values({{"rounding", "nearest"}}), (Values{"6", "18"}));
    EXPECT_EQ(values({{"contact_rule", "sat"}}), (Values{"6", "18"}));
    EXPECT_EQ(values({{"k", "14"}}), Values{"14"});
    EXPECT_EQ(values({{"rounding", "published"}}), Values{"18"});
    EXPECT_EQ(values({{"decision", "recheck"}}), Values{"18"});
    EXPECT_EQ(values({{"output", "pairs"}}), Values{"18"});
    EXPECT_EQ(of(exact).front().settings.text("k"), "18") << "unchanged presets first";
}

TEST(ChoosingCandidates, AutoIsSelectedByNameOnly) {
    Request request;
    const std::vector<DeviceGroup> devices{on_host()};
    for (const auto& cell : plan(request, devices)) EXPECT_TRUE(cell.candidates.empty());
    request.algorithms = {"auto", "chunked"};
    request.sets = {{"k", {"6", "18"}}};
    EXPECT_THROW(plan(request, devices), InputError); // a plan does not choose
    request.may_choose = true;
    const auto cells = plan(request, devices);
    ASSERT_EQ(cells.size(), 4u);
    EXPECT_EQ(cells[0].settings.text("k"), "6");
    EXPECT_EQ(cells[1].settings.text("k"), "18");
    EXPECT_GT(cells[1].candidates.size(), 5u);
    EXPECT_TRUE(cells[2].candidates.empty());
}

TEST(ChoosingCandidates, AreAskedForByClassAndByFixedSettings) {
    const auto question = [](const char* scene, std::uint64_t pairs, const SettingTexts& given) {
        return question_of(undecided_cell({}, given, on_host()), make_scene(scene), pairs);
    };
    const auto first = question("pile:bodies=4,frames=1", 100, {});
    EXPECT_EQ(question("pile:bodies=5,frames=1", 200, {}), first); // both are rounded down to 4^3 pairs
    // An explicit default matters only for an algorithm that has not been chosen yet.
    EXPECT_EQ(question("pile:bodies=4,frames=1", 100, {{"k", "18"}}), first);
    EXPECT_NE(question("pile:bodies=20,frames=1", 100, {}), first);
    for (const std::uint64_t pairs : {0, 256})
        EXPECT_NE(question("pile:bodies=4,frames=1", pairs, {}), first);
    for (const auto& given : {SettingTexts{{"k", "6"}}, {{"contact_rule", "none"}}, {{"threads", "1"}}})
        EXPECT_NE(question("pile:bodies=4,frames=1", 100, given), first);
}

} // namespace
} // namespace tandem
