// SPDX-License-Identifier: MIT
#pragma once

#include "base/error.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"

#include <iterator>
#include <unistd.h>

namespace tandem::support {

/// A test with its own temporary folder.
class FolderTest : public testing::Test {
protected:
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

private:
    std::filesystem::path folder_ = std::filesystem::path(testing::TempDir())
                                    / ("tandem-" + std::to_string(getpid())
                                       + testing::UnitTest::GetInstance()->current_test_info()->name());
};

inline std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::string& path, std::string_view bytes) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

} // namespace tandem::support
