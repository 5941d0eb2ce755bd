// SPDX-License-Identifier: MIT
#include "harness/plans/choosing/candidates.h"
#include "harness/plans/choosing/choice_cache.h"

#include "scenes/scene.h"
#include "tests/support/cells.h"
#include "tests/support/folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tandem {
namespace {

using support::bytes_of;
using support::write_bytes;
using testing::HasSubstr;

class ChoosingCache : public support::FolderTest {
protected:
    Cell cell_ = undecided_cell({}, {}, {&support::device("host")});
    Scene scene_ = make_scene("pile:bodies=4,frames=1");
    nlohmann::ordered_json question_ = question_of(cell_, scene_, 100);
    std::string warning_;

    static Choice made() {
        Choice choice;
        choice.candidates = {{"chunked", "resident", {{"builder", "sah"}}, 1000.5, 7, ""},
                             {"tiled", "resident", {}, 1500.75, 3, ""},
                             {"gproximity", "fair", {}, std::nullopt, 0, "device lost"}};
        choice.scene = "pile";
        choice.last = 3;
        choice.seconds = 1.5;
        return choice;
    }
};

TEST_F(ChoosingCache, ReturnsWhatItStored) {
    const ChoiceCache cache(path("a/b"), "1");
    EXPECT_EQ(cache.find(question_, warning_), std::nullopt);
    EXPECT_EQ(cache.keep(question_, made()), "");
    const auto found = cache.find(question_, warning_);
    ASSERT_TRUE(found);
    EXPECT_EQ(choice_json(*found), choice_json(made()));
    EXPECT_NEAR(found->margin().value(), 0.5, 1e-3);
    EXPECT_EQ(warning_, "");
    // no other file beside it
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("a/b")), {}), 1);
}

TEST_F(ChoosingCache, AnotherProgramVersionHasItsOwnChoices) {
    ChoiceCache(path(""), "1").keep(question_, made());
    EXPECT_EQ(ChoiceCache(path(""), "2").find(question_, warning_), std::nullopt);
    EXPECT_EQ(warning_, "");
    EXPECT_THAT(program_version(), HasSubstr("kernels "));
}

TEST_F(ChoosingCache, SurvivesEveryDamage) {
    const ChoiceCache cache(path(""), "1");
    cache.keep(question_, made());
    const auto file = cache.file_of(question_).string();
    const auto whole = bytes_of(file);
    for (std::size_t size = 0; size + 2 < whole.size(); ++size) { // the last bytes are "}\n"
        write_bytes(file, whole.substr(0, size));
        EXPECT_EQ(cache.find(question_, warning_), std::nullopt) << size;
        EXPECT_THAT(warning_, HasSubstr(file)) << size;
    }
    for (const auto& [what, instead] :
         {std::pair{"1000.5", "\"fast\""}, {"\"candidates\"", "\"candidate\""}, {"\"sah\"", "{}"}}) {
        auto text = whole;
        text.replace(text.rfind(what), std::string_view(what).size(), instead);
        write_bytes(file, text);
        EXPECT_EQ(cache.find(question_, warning_), std::nullopt) << what;
        EXPECT_THAT(warning_, HasSubstr(file)) << what;
    }
}

TEST_F(ChoosingCache, ReportsAFolderThatCannotBeWritten) {
    write_bytes(path("file"), "in the way");
    const ChoiceCache cache(path("file") + "/below", "1");
    EXPECT_THAT(cache.keep(question_, made()), HasSubstr("cannot be written"));
    EXPECT_EQ(ChoiceCache("", "1").keep(question_, made()), ""); // caching is off
    EXPECT_EQ(ChoiceCache("", "1").find(question_, warning_), std::nullopt);
}

TEST_F(ChoosingCache, KeysByClassAndByFixedSettings) {
    EXPECT_EQ(question_of(cell_, scene_, 200), question_); // both round up to 4^3
    EXPECT_NE(question_of(cell_, scene_, 256), question_);
    EXPECT_NE(question_of(cell_, scene_, 0), question_);
    EXPECT_EQ(question_of(cell_, make_scene("pile:bodies=5,frames=1"), 100), question_);
    EXPECT_NE(question_of(cell_, make_scene("pile:bodies=20,frames=1"), 100), question_);
    for (const auto& given : {SettingTexts{{"k", "6"}}, {{"contact_rule", "none"}}, {{"threads", "1"}}})
        EXPECT_NE(question_of(undecided_cell({}, given, cell_.devices), scene_, 100), question_);
    // An explicit default matters only for an algorithm that has not been chosen yet.
    EXPECT_EQ(question_of(undecided_cell({}, {{"k", "18"}}, cell_.devices), scene_, 100), question_);
}

} // namespace
} // namespace tandem
