// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

namespace tandem::simulate {

/// A face that bounds a mesh, seen from a point.
struct NearFace {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< outward, of length 1
    double height = 0;                                ///< m, of the face's plane over the point
};

/// The boundary of a mesh, in its own axes, by the tetrahedra that touch it.
class Boundary {
public:
    explicit Boundary(const Mesh& mesh);

    /// Of the boundary faces that share a vertex with `tetrahedron` those no farther from `point` than the
    /// nearest of them and `slack` (m) more; of those with equal normals the lowest. None inside of a body.
    void near(const Mesh& mesh, std::uint32_t tetrahedron, const Eigen::Vector3d& point, double slack,
              std::vector<NearFace>& faces) const;

private:
    struct Face {
        std::array<std::uint32_t, 3> vertices{};
        Eigen::Vector3d normal;
    };

    std::vector<Face> faces_;
    /// Faces at vertex v: at_[first_[v]] until at_[first_[v + 1]].
    std::vector<std::uint32_t> first_, at_;
};

/// Of `point` from a triangle (Ericson, "Real-time collision detection", 2005, 5.1.5).
double squared_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c);

} // namespace tandem::simulate
