// SPDX-License-Identifier: MIT
#include "tests/loader/files.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"

#include "base/error.h"
#include "scenes/mesh.h"

#include <unistd.h>

namespace tandem::loader {
namespace {

/// Temporary directory of this process; removed at exit.
struct Folder {
    std::filesystem::path path =
        std::filesystem::path(testing::TempDir()) / ("tandem-" + std::to_string(getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
};

} // namespace

std::string folder() {
    static const Folder folder;
    return folder.path.string();
}

std::string write_file(const std::string& name, std::string_view bytes) {
    auto path = folder() + "/" + name;
    std::filesystem::remove(path); // ext4 flushes a file that is truncated and rewritten
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << "the text to replace is missing: " << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// The mesh in the example of every format: two tetrahedra that share a face, and an unused vertex.
void expect_example(const Mesh& mesh, bool single) {
    const std::vector<Eigen::Vector3d> vertices = {{0, 0, 0},   {1, 0, 0},         {0, 1, 0},
                                                   {0, 0, 1.5}, {-0.25, 2, 0.125}, {0.1, 0.2, -3e-7}};
    ASSERT_EQ(mesh.vertices.size(), vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v)
        EXPECT_EQ(mesh.vertices[v], single ? vertices[v].cast<float>().cast<double>().eval() : vertices[v])
            << v;
    EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {4, 3, 2, 1}}));
}

void expect_pressures(const std::string& name, std::string_view bytes, bool single) {
    SCOPED_TRACE(name);
    const auto mesh = read_mesh(write_file(name, bytes));
    expect_example(mesh, single);
    EXPECT_EQ(mesh.pressures, (std::vector<double>{0, 0.5, 1.25, 0, 3e7, 0.125}));
}

/// Expects one line as the error for these bytes: path, `location`, ... `reason` ...; message to do.
void expect_failure(const std::string& name, std::string_view bytes, const std::string& location,
                    std::string_view reason) {
    const auto path = write_file(name, bytes);
    SCOPED_TRACE(name + location + std::string(reason));
    const auto message = support::message_of([&] { read_mesh(path); });
    EXPECT_TRUE(message.starts_with(path + location)) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_NE(message.find("; "), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

} // namespace tandem::loader
