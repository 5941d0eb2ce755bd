// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"
#include "algorithms/distributed/subdomain.h"
#include "scenes/scene.h"

namespace tandem {

/// The part of a scene that has these bodies alone, which are ascending, and their meshes. Numbered anew, so
/// that whatever is kept by body is as large as the part; answers name bodies as the whole scene does.
std::shared_ptr<const Scene> local_subscene(const Scene& scene, const std::vector<std::uint32_t>& bodies);

/// Where the part has a body that the whole scene numbers so; it has it.
std::size_t local_index(const Scene& part, std::uint32_t number);

/// A share of the whole scene's bodies, all of which are in the part, as the part numbers them.
Subdomain to_local(const Scene& part, const Subdomain& subdomain);

/// The same part of an answer, which keeps that scene alive.
std::shared_ptr<const AnswerPart> owning_part(std::shared_ptr<const AnswerPart> part,
                                              std::shared_ptr<const Scene> scene);

} // namespace tandem
