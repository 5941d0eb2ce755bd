// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/body_memory.h"
#include "scenes/parameters.h"

namespace tandem {

/// The settings that the paper's scenes are measured with, in place of the defaults, which are for scenes of
/// one's own: no correction of positions, its damping, and a solver that ends early in heaps.
StepSettings measured_stepping();
SolverSettings measured_solver();

/// The materials of the paper's rigid scenes, brick, earth and iron, with the settings they are measured
/// with.
namespace masonry {
enum : std::uint32_t { stone, ground, cannonball };
Dynamics dynamics();
} // namespace masonry

/// How a rigid body is put into a scene.
struct Placing {
    Pose pose;
    std::uint32_t material = 0;
    bool fixed = false;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero(); ///< m/s
};

/// A scene with dynamics under construction.
class Assembly {
public:
    /// Refines every mesh as the parameter `refine` says.
    explicit Assembly(std::span<const SceneParameter> parameters);

    Dynamics dynamics; ///< for the caller to fill in; add() fills `bodies`

    /// Numbers of meshes in the scene. Boxes of equal size share one; sizes are halved_on_grid.
    std::uint32_t add_mesh(const Mesh& mesh);
    std::uint32_t add_box(const Eigen::Vector3d& size);
    const Mesh& mesh(std::uint32_t number) const { return scene_.meshes[number]; }

    /// Throws InputError where so many bodies of a mesh are more than there is memory for.
    void expect(std::uint64_t bodies, std::uint32_t mesh) const {
        refuse_bodies_beyond_memory(bodies, scene_.meshes[mesh], 0);
    }
    void add(std::uint32_t mesh, const Placing& placing);
    /// A deformable body: its mesh turned by `turn` about the vertical, then moved.
    void add_deformable(std::uint32_t mesh, double turn, const Eigen::Vector3d& translation,
                        std::int32_t elastic);
    /// The ground: a fixed square box one metre thick, its top at y = 0.
    void add_ground(double width, std::uint32_t material);

    /// Ends the construction.
    Scene finish();

private:
    std::uint64_t refine_;
    Scene scene_;
    Frame start_;
    std::vector<std::pair<Eigen::Vector3d, std::uint32_t>> boxes_;
};

/// Bodies in a regular block twice as high as it is wide, layer by layer from `bottom`, about the y-axis: the
/// footprint is the least square that this shape needs, and no more than 10 x 10 (the paper's 10 x 20 x 10).
std::vector<Eigen::Vector3d> block(std::size_t bodies, double pitch, double bottom);

} // namespace tandem
