// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem::description {

/// The motion of a deformable body: mesh files, one a frame, such as other simulators write.
class Series {
public:
    /// Reads all files once. Throws InputError for a file that is no mesh, or whose tetrahedra are not those
    /// of `mesh` in the same order.
    Series(std::vector<std::string> paths, const Mesh& mesh);

    /// World vertices of a frame. Reads its file again, so that no frames are kept in memory. Throws
    /// InputError if the file has changed.
    std::vector<Eigen::Vector3d> vertices(std::size_t frame) const;
    /// Digest of the vertices of all frames.
    std::uint64_t digest() const;

private:
    std::vector<std::string> paths_;
    std::vector<std::uint64_t> digests_; ///< of the vertices of each file
};

} // namespace tandem::description
