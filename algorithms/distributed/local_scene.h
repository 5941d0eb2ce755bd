// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"
#include "algorithms/bodies/subdomain.h"
#include "scenes/scene.h"

namespace tandem {

/// The subscene of these bodies, given in ascending order, and their meshes. Its bodies are renumbered, so
/// that arrays by body have the size of the subscene. Answers use the body numbers of the whole scene.
std::shared_ptr<const Scene> local_subscene(const Scene& scene, const std::vector<std::uint32_t>& bodies);

/// The index in the subscene of the body that the whole scene numbers `number`; the subscene must have it.
std::size_t local_index(const Scene& local_scene, std::uint32_t number);

/// The subdomain with body numbers of the subscene, which must have all its bodies.
Subdomain to_local(const Scene& local_scene, const Subdomain& subdomain);

/// The same part of an answer, which in addition keeps the scene alive.
std::shared_ptr<const AnswerPart> owning_part(std::shared_ptr<const AnswerPart> part,
                                              std::shared_ptr<const Scene> scene);

} // namespace tandem
