// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem::simulate {

/// A boundary face of a mesh relative to a point.
struct NearFace {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< outward, of length 1
    double height = 0;                                ///< m, height of the face's plane above the point
};

/// The boundary of a mesh in mesh axes, indexed by vertices.
class Boundary {
public:
    explicit Boundary(const Mesh& mesh);

    /// Finds boundary faces that share a vertex with `tetrahedron` and are at most `slack` (m) farther from
    /// `point` than the nearest such face. Keeps only the lowest of faces with equal normals.
    void near(const Mesh& mesh, std::uint32_t tetrahedron, const Eigen::Vector3d& point, double slack,
              std::vector<NearFace>& faces) const;

private:
    struct Face {
        std::array<std::uint32_t, 3> vertices{};
        Eigen::Vector3d normal;
    };

    std::vector<Face> faces_;
    /// Faces at vertex v: at_[first_[v]] up to, not including, at_[first_[v + 1]].
    std::vector<std::uint32_t> first_, at_;
};

/// Squared distance (m^2) of `point` from a triangle (Ericson, "Real-time collision detection", 2005, 5.1.5).
double squared_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c);

} // namespace tandem::simulate
