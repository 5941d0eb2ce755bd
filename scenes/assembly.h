// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/body_memory.h"
#include "scenes/parameters.h"

namespace tandem {

/// The settings of the measured scenes of the paper; user scenes start from the defaults instead. Positions
/// are not corrected, damping has the paper's value, and the solver ends early in heaps.
StepSettings measured_stepping();
SolverSettings measured_solver();

/// Materials of the paper's rigid scenes (brick, earth and iron) with the settings of their measurements.
namespace masonry {
enum : std::uint32_t { stone, ground, cannonball };
Dynamics dynamics();
} // namespace masonry

/// Pose, material and initial motion of a rigid body.
struct BodyPlacement {
    Pose pose;
    std::uint32_t material = 0;
    bool fixed = false;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero(); ///< m/s
};

/// A scene with dynamics under construction.
class Assembly {
public:
    /// Refines every mesh by the levels of the parameter `refine`.
    explicit Assembly(std::span<const SceneParameter> parameters);

    Dynamics dynamics; ///< the caller fills it in; add() fills `bodies`

    /// Return the mesh's number in the scene. Boxes of equal size share a mesh; sizes are halved_on_grid.
    std::uint32_t add_mesh(const Mesh& mesh);
    std::uint32_t add_box(const Eigen::Vector3d& size);
    const Mesh& mesh(std::uint32_t number) const { return scene_.meshes[number]; }

    /// Throws InputError when memory does not suffice for this many bodies of a mesh.
    void check_memory(std::uint64_t bodies, std::uint32_t mesh) const {
        refuse_bodies_beyond_memory(bodies, scene_.meshes[mesh], 0);
    }
    void add(std::uint32_t mesh, const BodyPlacement& placement);
    /// Adds a deformable body: its mesh rotated by `turn` radians about the vertical, then translated.
    void add_deformable(std::uint32_t mesh, double turn, const Eigen::Vector3d& translation,
                        std::int32_t elastic);
    /// Adds the ground: a fixed square box one metre thick, its top at y = 0.
    void add_ground(double width, std::uint32_t material);

    /// Returns the scene; the assembly is empty afterwards.
    Scene finish();

private:
    std::uint64_t refine_;
    Scene scene_;
    Frame start_;
    std::vector<std::pair<Eigen::Vector3d, std::uint32_t>> boxes_;
};

/// Centres of bodies in a regular block about the y-axis, layer by layer from `bottom`, twice as high as
/// wide. The footprint is the smallest square for this shape, at most 10 x 10 (the paper's 10 x 20 x 10).
std::vector<Eigen::Vector3d> block(std::size_t bodies, double pitch, double bottom);

} // namespace tandem
