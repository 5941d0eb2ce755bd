// SPDX-License-Identifier: MIT
#include "harness/compare/cells.h"
#include "harness/compare/labels.h"
#include "scenes/error.h"
#include "tests/unit/compare_records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tandem::compare {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string refusal(const std::string& file, const std::string& commit = "") {
    try {
        read_cells(file, commit);
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was refused";
}

std::string refusal_of(const nlohmann::json& record) {
    const TemporaryFile file(Records{record});
    return refusal(file.path());
}

TEST(CompareCells, RoundsAreMediansOfTheirSamples) {
    const TemporaryFile file(Records{record("8", {5, 1, 9, 4, 2, 30}, {2, 1, 2, 1, 1, 2}, "s")});
    const auto cells = read_cells(file.path(), "").cells;
    ASSERT_EQ(cells.size(), 1u);
    ASSERT_EQ(cells[0].rounds.size(), 2u);
    EXPECT_EQ(cells[0].rounds[0].number, 1);
    EXPECT_EQ(cells[0].rounds[0].ns, 2);
    EXPECT_EQ(cells[0].rounds[1].number, 2);
    EXPECT_EQ(cells[0].rounds[1].ns, 9);
    EXPECT_EQ(cells[0].samples, 6u);
    EXPECT_EQ(cells[0].session, "s");
    EXPECT_EQ(cells[0].seed, 7u);
    EXPECT_TRUE(cells[0].on_gpus);
}

TEST(CompareCells, WithoutRoundsEverySampleIsOne) {
    const TemporaryFile file(Records{record("8", {5, 1, 9})});
    const auto cells = read_cells(file.path(), "").cells;
    ASSERT_EQ(cells[0].rounds.size(), 3u);
    EXPECT_EQ(cells[0].rounds[1].ns, 1);
    EXPECT_TRUE(cells[0].session.empty());
    EXPECT_FALSE(cells[0].seed);
}

TEST(CompareCells, TheLastRecordThatIsOkCounts) {
    auto failed = record("8", {1});
    failed["status"] = "failed";
    failed["failure"] = "device lost";
    failed["total_ns"] = nullptr;
    failed["work"] = nullptr;
    const TemporaryFile file(
        Records{record("8", {1}), record("18", {2}), record("8", {3}), failed, record("26", {})});
    const auto read = read_cells(file.path(), "");
    ASSERT_EQ(read.cells.size(), 2u);
    EXPECT_EQ(read.cells[0].rounds[0].ns, 3);
    EXPECT_EQ(read.cells[0].line, 3u);
    EXPECT_EQ(read.cells[1].key, "18");
    EXPECT_EQ(read.repeated, 1u);
    EXPECT_EQ(read.records, 5u);
    ASSERT_EQ(read.left_out.size(), 2u);
    EXPECT_EQ(read.left_out[0].failure, "device lost");
    EXPECT_EQ(read.left_out[1].key, "26");
}

TEST(CompareCells, CommitsAreFoundByTheirBeginnings) {
    Records records{record("8", {1}), record("8", {2}), record("8", {3})};
    records[1]["environment"]["commit"] = "abd2";
    records[2]["environment"]["commit"] = nullptr;
    const TemporaryFile file(records);
    EXPECT_EQ(read_cells(file.path(), "abd").cells[0].rounds[0].ns, 2);
    EXPECT_EQ(read_cells(file.path() + "@abc1", "").cells[0].rounds[0].ns, 1);
    EXPECT_THAT(read_cells(file.path(), "").commits, ElementsAre(""));
    EXPECT_THAT(refusal(file.path(), "ab"), HasSubstr("commit ab may be abc1 or abd2"));
    EXPECT_THAT(refusal(file.path(), "f"),
                AllOf(HasSubstr("no record of commit f"), HasSubstr("abc1, abd2")));
    EXPECT_THAT(refusal(file.path() + "@abc1", "abd2"), HasSubstr("name one commit"));
    EXPECT_THAT(refusal(file.path() + "@"), HasSubstr("no commit behind the @"));
}

TEST(CompareCells, ALineWithoutAnEndIsIgnored) {
    const auto whole = TemporaryFile::lines({record("8", {1}), record("18", {1})});
    for (const std::size_t cut : {1, 40}) {
        const TemporaryFile file(whole.substr(0, whole.size() - cut));
        const auto read = read_cells(file.path(), "");
        EXPECT_TRUE(read.torn);
        EXPECT_EQ(read.cells.size(), 1u);
    }
    const TemporaryFile file(whole);
    EXPECT_FALSE(read_cells(file.path(), "").torn);
}

TEST(CompareCells, RefusesWhatIsNoRecord) {
    const TemporaryFile empty("");
    EXPECT_EQ(refusal(empty.path()), empty.path() + ": is empty; name a file of records");
    const TemporaryFile torn("{\"schema\": 2");
    EXPECT_THAT(refusal(torn.path()), HasSubstr("its only line has no end"));
    const TemporaryFile noise(TemporaryFile::lines({record("8", {1})}) + "\nnoise\n");
    EXPECT_THAT(refusal(noise.path()), HasSubstr(noise.path() + ":2: is not JSON; give"));
    EXPECT_THAT(refusal("/nowhere/at/all"), HasSubstr("cannot be read"));
    EXPECT_THAT(refusal("/tmp"), HasSubstr("is a folder"));
    EXPECT_THAT(refusal_of({1, 2}), HasSubstr(":1: is no record of a cell"));
    EXPECT_THAT(refusal_of({{"schema", 2}}), HasSubstr(":1: is no record of a cell"));
}

TEST(CompareCells, RefusesOtherSchemasAndFields) {
    const auto with = [](const char* path, const nlohmann::json& value) {
        auto json = record("8", {1, 2}, {0, 1}, "s");
        json[nlohmann::json::json_pointer(path)] = value;
        return refusal_of(json);
    };
    EXPECT_THAT(with("/schema", 1), HasSubstr("scripts/convert_records"));
    EXPECT_THAT(with("/schema", 4), HasSubstr("this program knows 2 and 3"));
    EXPECT_THAT(with("/schema", "2"), HasSubstr("is no record of a cell (type must be number"));
    EXPECT_THAT(with("/devices", 3), HasSubstr("is no record of a cell"));
    EXPECT_THAT(with("/environment", nullptr), HasSubstr("is no record of a cell"));
    EXPECT_THAT(with("/settings/k", 8), HasSubstr("is no record of a cell"));
    EXPECT_THAT(with("/total_ns/samples/0", 0), HasSubstr("a sample of 0 ns is no time"));
    EXPECT_THAT(with("/total_ns/rounds", {0}), HasSubstr("2 samples and 1 rounds"));
    EXPECT_THAT(with("/total_ns", {{"samples", {1}}}), HasSubstr("no rounds"));
}

std::vector<std::string> labels_of(const Records& records, std::string* common = nullptr) {
    const TemporaryFile file(records);
    const auto read = read_cells(file.path(), "");
    std::vector<const RecordedCell*> cells;
    for (const auto& cell : read.cells) cells.push_back(&cell);
    const auto labels = label(cells);
    if (common != nullptr) *common = labels.common;
    return labels.of;
}

TEST(CompareLabels, SayWhatDiffers) {
    Records records{record("8", {1}), record("18", {1}), record("9", {1}), record("10", {1})};
    records[2]["algorithm"] = "tiled";
    records[3]["scene"]["key"] = "pile:bodies=9,density=0.4";
    records[3]["settings"]["k"] = "8";
    std::string common;
    EXPECT_THAT(labels_of(records, &common), ElementsAre("chunked bodies=2 k=8", "chunked bodies=2 k=18",
                                                         "tiled bodies=2 k=9", "chunked bodies=9 k=8"));
    EXPECT_EQ(common, "resident, cuda:0, GPU, 1, pile, frames 0:9");
}

TEST(CompareLabels, OneCellAndCellsThatOnlyKeysTellApart) {
    EXPECT_THAT(labels_of({record("8", {1})}), ElementsAre("chunked"));
    Records records{record("8", {1}), record("18", {1})};
    records[1]["settings"]["k"] = "8";
    EXPECT_THAT(labels_of(records), ElementsAre("chunked", "chunked #2"));
    // What looks like parameters and is not, or has names of settings, stays the scene's name.
    records[0]["scene"]["key"] = "mesh:a.msh";
    records[1]["scene"]["key"] = "pile:k=3";
    EXPECT_THAT(labels_of(records), ElementsAre("mesh:a.msh", "pile:k=3"));
}

} // namespace
} // namespace tandem::compare
