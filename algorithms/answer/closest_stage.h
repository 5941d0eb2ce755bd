// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/answers.h"
#include "algorithms/answer/closest.cl.h"
#include "algorithms/answer/status.h"

namespace tandem {

/// output=distances: keeps of the contacts of each body pair the one with the least distance, on the device.
/// Equal distances go to the smaller numbers of the tetrahedra. Buffers: as many bytes as the contacts have,
/// and 8 to 16 for each body pair.
class ClosestStage {
public:
    /// `bodies` must outlive this.
    ClosestStage(const Bodies& bodies, LaunchShape shape);

    /// Where the contacts go of which it keeps some. Throws OutOfMemory.
    ContactRows source(const AnswerBuffers& answer);
    /// Enqueues it: the kept contacts to `kept`, and their number to the status. `body_pairs`: at least the
    /// number of body pairs that have contacts. Throws OutOfMemory.
    void launch(const AnswerBuffers& answer, const ContactRows& kept, std::uint64_t body_pairs,
                const Status& status);

private:
    const Bodies& bodies_;
    LaunchShape shape_;
    GrowableBuffer contacts_, table_;
    KernelOf<kernels::closest::FindClosest> find_;
    KernelOf<kernels::closest::KeepClosest> keep_;
    KernelOf<kernels::closest::CountClosest> count_;
};

} // namespace tandem
