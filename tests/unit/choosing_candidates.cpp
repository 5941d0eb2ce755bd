// SPDX-License-Identifier: MIT
#include "harness/plans/choosing/candidates.h"

#include "algorithms/narrow_phase/contact_settings.h"
#include "base/error.h"
#include "tests/support/cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tandem {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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
    EXPECT_EQ(values_of(cells, "chunked", "leaves"), (std::set<std::string>{"0", "8", "64", "512"}));
    EXPECT_EQ(values_of(cells, "tiled", "slabs"), (std::set<std::string>{"usual", "all"}))
        << "`usual` equals `three`";
    for (const auto* traversal : algorithms())
        EXPECT_EQ(values_of(cells, traversal->name(), "builder"), (std::set<std::string>{"morton", "sah"}));
}

/// On a device with groups of one work-item, all group sizes are one candidate.
TEST(ChoosingCandidates, AreAllDifferent) {
    const auto cells = of({});
    std::set<std::string> different;
    for (const auto& cell : cells) {
        EXPECT_EQ(cell.settings.text("group_size"), "0");
        different.insert(describe(cell));
    }
    EXPECT_EQ(different.size(), cells.size());
}

TEST(ChoosingCandidates, ExplicitSettingsAreKept) {
    const auto cells = of({{"k", "8"}, {"builder", "morton"}, {"leaves", "32"}, {"contact_rule", "none"}});
    ASSERT_FALSE(cells.empty());
    for (const auto& cell : cells) {
        EXPECT_EQ(cell.settings.text("k"), "8");
        EXPECT_EQ(cell.settings.text("builder"), "morton");
        EXPECT_EQ(cell.settings.text("contact_rule"), "none");
    }
    EXPECT_EQ(values_of(cells, "chunked", "leaves"), std::set<std::string>{"32"});
    // A value of `leaves` would override the chunk's bytes.
    EXPECT_EQ(values_of(of({{"chunk_bytes", "20000"}}), "chunked", "leaves"), std::set<std::string>{"0"});
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

/// Sums of three coordinates are rounded twice, so their bounds miss pairs without safe rounding.
TEST(ChoosingCandidates, ContactsAreEqualForEveryKWhoseBoundsMissNothing) {
    const auto& tiled = algorithm("tiled");
    for (const auto& k : parameters::k.choices()) {
        const auto equal = [&](const std::string& rounding) {
            const SettingTexts given{{"k", std::string(k.text)},
                                     {"rounding", rounding},
                                     {"output", "contacts"},
                                     {"decision", "exact"}};
            return contacts_are_equal_for_every_k(resolve(tiled.parameters(), {}, given, tiled.name()));
        };
        EXPECT_TRUE(equal("safe")) << k.text;
        EXPECT_TRUE(equal("directed")) << k.text;
        EXPECT_FALSE(equal("published")) << k.text;
        EXPECT_EQ(equal("nearest"), k.value == 6 || k.value == 12 || k.value == 16 || k.value == 18)
            << k.text;
    }
}

TEST(ChoosingCandidates, SettingsOfNoCandidateAreRefused) {
    EXPECT_EQ(support::declares(*algorithms().front(), "axes"), true);
    EXPECT_THROW(of({{"axes", "coordinate"}}), InputError);
    EXPECT_THROW(of({{"k", "10"}}), InputError);
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
    EXPECT_GT(cells[1].candidates.size(), 10u);
    EXPECT_TRUE(cells[2].candidates.empty());
}

} // namespace
} // namespace tandem
