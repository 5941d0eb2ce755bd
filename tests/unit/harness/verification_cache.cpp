// SPDX-License-Identifier: MIT
#include "harness/frames/frames.h"
#include "harness/verify/references.h"
#include "harness/verify/verification_cache.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

class StoredValues : public testing::Test {
protected:
    ~StoredValues() override { std::filesystem::remove_all(folder_); }

    /// The value that another object finds, as another process would; -1 for none.
    int found(const std::string& subject, const std::string& question) const {
        int value = -1;
        const VerificationCache values(folder_, subject);
        const bool found_value =
            values.take(question, [&](const nlohmann::json& json) { value = json.get<int>(); });
        return found_value ? value : -1;
    }

    std::filesystem::path folder_ = testing::TempDir() + "kept-" + std::to_string(getpid());
};

TEST_F(StoredValues, ValuesAreFoundByQuestionAndSubject) {
    VerificationCache values(folder_, "a");
    values.keep("one", 1);
    values.keep("two", 2);
    values.keep("one", 3); // the last value counts
    EXPECT_EQ(found("a", "one"), 3);
    EXPECT_EQ(found("a", "two"), 2);
    EXPECT_EQ(found("b", "one"), -1);
    EXPECT_EQ(found("a", "three"), -1);
}

TEST_F(StoredValues, InvalidValuesAreMissing) {
    VerificationCache(folder_, "a").keep("one", "text");
    EXPECT_EQ(found("a", "one"), -1);
    std::filesystem::path file;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) file = entry.path();
    std::ofstream(file, std::ios::app) << R"({"question":"torn","val)";
    VerificationCache(folder_, "a").keep("two", 2);
    EXPECT_EQ(found("a", "torn"), -1);
    EXPECT_EQ(found("a", "two"), 2);
}

TEST_F(StoredValues, AnUnusableFolderCausesNoFailure) {
    VerificationCache nowhere;
    nowhere.keep("one", 1);
    VerificationCache("/dev/null/kept", "a").keep("one", 1);
    EXPECT_FALSE(nowhere.take("two", [](const nlohmann::json&) {}));
    EXPECT_EQ(found("a", "one"), -1);
}

/// Every member of a geometry that changes the answer is a part of the question.
TEST_F(StoredValues, EachGeometryHasItsOwnReference) {
    const auto scene = support::crowd(31, 4, 1);
    const FrameRange range(scene, 0, 0);
    std::vector<Geometry> geometries(8);
    geometries[1].k = 8;
    geometries[2] = {.k = 8, .coordinate_axes = true};
    geometries[3].precision = Precision::fp64;
    geometries[4] = {.k = 8, .rounding = Rounding::published};
    geometries[5].placement = Placement::exact;
    geometries[6].margin = 0.1;
    geometries[7].margin = 0.2;
    std::vector<Digest> computed;
    References references(scene, range);
    for (const auto& geometry : geometries) computed.push_back(references.digests(geometry, {}, 0).pairs);
    EXPECT_LT(computed[0].count, computed[6].count);
    for (int time = 0; time < 2; ++time) { // the second time from the file
        References stored(scene, range, folder_);
        for (std::size_t i = 0; i < geometries.size(); ++i)
            EXPECT_EQ(stored.digests(geometries[i], {}, 0).pairs, computed[i]) << time << " " << i;
    }
}

} // namespace
} // namespace tandem
