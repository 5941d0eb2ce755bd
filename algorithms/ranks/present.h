// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"
#include "algorithms/shares/share.h"
#include "scenes/scene.h"

namespace tandem {

/// The scene with all of its bodies' numbers, of which only these are there: the others have a mesh without
/// tetrahedra, and meshes that none of these has are left out. Its frames are the whole scene's.
std::shared_ptr<const Scene> scene_of(const Scene& scene, const std::vector<bool>& is_present);

/// The same part of an answer, which keeps that scene alive.
std::shared_ptr<const AnswerPart> kept_part(std::shared_ptr<const AnswerPart> part,
                                            std::shared_ptr<const Scene> scene);

} // namespace tandem
