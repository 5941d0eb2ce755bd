// SPDX-License-Identifier: MIT
#include "scenes/description/series.h"

#include "base/digest.h"
#include "base/error.h"
#include "scenes/read/read.h"

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

Series::Series(std::vector<std::string> paths, const Mesh& mesh, const MeshReading& reading)
    : paths_(std::move(paths)), reading_(reading) {
    for (const auto& path : paths_) {
        const auto state = parse_file(path, reading_);
        if (state.tetrahedra != mesh.tetrahedra || state.vertices.size() != mesh.vertices.size())
            throw InputError(
                fmt::format("{}: has other tetrahedra or vertices than the mesh of its body, {}; give "
                            "files of one mesh",
                            path, mesh.name));
        for (std::size_t v = 0; v < state.vertices.size(); ++v)
            if (!state.vertices[v].allFinite())
                throw InputError(fmt::format("{}: vertex {} is not finite; repair the file", path, v));
        digests_.push_back(digest_of_vertices(state));
    }
}

std::vector<Eigen::Vector3d> Series::vertices(std::size_t frame) const {
    auto state = parse_file(paths_[frame], reading_);
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
