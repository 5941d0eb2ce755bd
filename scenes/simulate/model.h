// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"
#include "scenes/simulate/boundary.h"
#include "scenes/simulate/elastic.h"
#include "scenes/simulate/mass.h"

namespace tandem::simulate {

enum class BodyKind { fixed, rigid, soft };

/// Constant properties of a body.
struct BodyModel {
    BodyKind kind = BodyKind::fixed;
    std::uint32_t material = 0;
    double size = 0;                                           ///< m, longest edge of the mesh's box
    MassProperties mass;                                       ///< rigid bodies only
    Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero(); ///< rigid bodies only, in mesh axes
    ElasticMesh elastic;                                       ///< soft bodies only
};

/// A scene with dynamics, checked and prepared.
struct Model {
    const Scene* scene = nullptr;
    const Dynamics* dynamics = nullptr;
    std::vector<BodyModel> bodies;
    std::vector<Boundary> boundaries; ///< one a mesh; empty without surface_normals
    Frame start;
    /// Extremes over rigid bodies and vertices of deformable bodies: kg, m, and m/s at the start.
    double lightest = 0, smallest = 0, fastest = 0;
    double highest_energy = 0; ///< J; the motion diverges when kinetic + potential + elastic exceed it

    const Surface& surface(std::uint32_t a, std::uint32_t b) const {
        return dynamics->materials.surface(bodies[a].material, bodies[b].material);
    }
};

/// Throws InputError with the fault and the body when the scene's dynamics are impossible. The caller sets
/// `highest_energy`.
Model make_model(const Scene& scene);

} // namespace tandem::simulate
