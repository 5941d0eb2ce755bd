// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/pipeline/pipeline.h"

namespace tandem {

/// Runs a frame that does not fit into memory in batches, as the paper's relaunching on a backlog. The body
/// pairs are split into `batches` parts at first, and into more if necessary; a single body pair is split by
/// the items of its body a. `batches` becomes the number for the next similar frame. Pairs and contacts of a
/// finished part move to the host's memory. Bodies and hierarchy must be those of the frame. `input` is null
/// for a frame in the device's memory. Throws OutOfMemory if the pairs of a single item do not fit.
FrameResult run_in_batches(Pipeline& pipeline, const FrameInput* input,
                           std::optional<std::span<const BodyPair>> given, std::uint64_t& batches);

} // namespace tandem
