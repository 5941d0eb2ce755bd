// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "scenes/scene.h"

#include <memory>

namespace tandem {

/// The shift of a mesh: along each axis the middle of its tetrahedra if its magnitude exceeds 8 times their
/// extent along that axis, otherwise 0. Subtracting it from a vertex of a tetrahedron is exact
/// (bodies/README.md, lemma 9).
Eigen::Vector3d shift_of(const Mesh& mesh);

/// Whether a mesh of the scene has a shift.
bool has_far_mesh(const Scene& scene);

/// The scene with every mesh centred: its vertices without the mesh's shift, and frames with shifted() poses.
/// Scene::shifts has the shifts. Null with Origin::world, and if all shifts are 0. `scene` must outlive the
/// result.
std::shared_ptr<const Scene> centred(const Scene& scene, Origin origin);

/// The pose of a body's centred mesh, R(q) c + t for the shift c, in double. The same pose if c is 0.
Pose shifted(const Pose& pose, const Eigen::Vector3d& shift);

/// The same for all rigid bodies of a frame.
Frame shifted(const Scene& centred, Frame frame);

/// The shift of a mesh by its number in the scene; 0 unless the scene is centred.
Eigen::Vector3d shift_in(const Scene& scene, std::size_t mesh);

} // namespace tandem
