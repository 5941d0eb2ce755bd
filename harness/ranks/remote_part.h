// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"
#include "harness/ranks/orders.h"

namespace tandem {

/// By all ranks, once each has run a frame: the first one's answer gets what the others have found, their
/// counts, and parts that ask them for pairs and contacts when they are asked. `number`: of the answer.
void add_remote_parts(FrameResult& result, Ranks& ranks, std::uint64_t number);

/// What a rank says of its own answer: to add_remote_parts(), and to orders of an answer's number.
Ranks::Bytes totals_of(const FrameResult& result);
Ranks::Bytes said_of(const FrameResult& result, Order order);

} // namespace tandem
