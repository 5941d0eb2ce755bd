// SPDX-License-Identifier: MIT
#include "scenes/description/series.h"

#include "base/digest.h"
#include "base/error.h"

#include <fmt/format.h>

namespace tandem::description {

namespace {

std::uint64_t digest_of_vertices(const Mesh& mesh) {
    Digester digester;
    for (const auto& vertex : mesh.vertices)
        for (const double x : vertex) digester.add(x);
    return digester.value();
}

} // namespace

Series::Series(std::vector<std::string> paths, const Mesh& mesh) : paths_(std::move(paths)) {
    for (const auto& path : paths_) {
        const auto state = read_mesh(path);
        if (state.tetrahedra != mesh.tetrahedra || state.vertices.size() != mesh.vertices.size())
            throw InputError(
                fmt::format("{}: has other tetrahedra or vertices than the mesh of its body, {}; give "
                            "files of one mesh",
                            path, mesh.name));
        digests_.push_back(digest_of_vertices(state));
    }
}

std::vector<Eigen::Vector3d> Series::vertices(std::size_t frame) const {
    auto state = read_mesh(paths_[frame]);
    if (digest_of_vertices(state) != digests_[frame])
        throw InputError(
            fmt::format("{}: has changed since the scene was loaded; load it again", paths_[frame]));
    return std::move(state.vertices);
}

std::uint64_t Series::digest() const {
    Digester digester;
    for (const auto digest : digests_) digester.add(digest);
    return digester.value();
}

} // namespace tandem::description
