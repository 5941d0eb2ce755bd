// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem::description {

/// The motion of a deformable body: mesh files, one a frame, such as other simulators write.
class Series {
public:
    /// Reads all files once, with the readers' options of `reading`. Throws InputError for a file that is no
    /// mesh, whose tetrahedra are not those of `mesh` in the same order, or with a coordinate that is not
    /// finite.
    Series(std::vector<std::string> paths, const Mesh& mesh, const MeshReading& reading);

    /// World vertices of a frame. Reads its file again, so that no frames are kept in memory. Throws
    /// InputError if the file has changed.
    std::vector<Eigen::Vector3d> vertices(std::size_t frame) const;
    /// Digest of the vertices of all frames.
    std::uint64_t digest() const;

private:
    std::vector<std::string> paths_;
    MeshReading reading_;
    std::vector<std::uint64_t> digests_; ///< of the vertices of each file
};

} // namespace tandem::description
