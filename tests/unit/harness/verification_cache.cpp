// SPDX-License-Identifier: MIT
#include "harness/verify/verification_cache.h"
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

} // namespace
} // namespace tandem
