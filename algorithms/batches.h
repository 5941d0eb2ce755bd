// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/pipeline.h"

namespace tandem {

/// A frame that does not fit into memory, part after part: the paper's relaunching on a backlog. It is split
/// by body pairs into `batches` at first, and where that is not enough into more (`batches` is then what a
/// like frame should begin with); a body pair that alone does not fit is split by the items of its body a.
/// Pairs and contacts of a part that has ended move to the host's memory. Bodies and hierarchy are those of
/// `frame` already; null: the frame is in the device's memory. Throws OutOfMemory when not even one item's
/// pairs fit.
FrameResult run_in_batches(Pipeline& pipeline, const Frame* frame,
                           std::optional<std::span<const BodyPair>> given, std::uint64_t& batches);

} // namespace tandem
