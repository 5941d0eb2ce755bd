// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/answers.h"
#include "algorithms/answer/queued.cl.h"
#include "algorithms/answer/queued_frame.h"
#include "algorithms/answer/status.h"

#include <optional>

namespace tandem {

/// A counter of the status (status.clh), and the most that it may count before something is lost.
struct Limit {
    std::uint32_t counter = 0;
    std::uint32_t most = 0;
};

/// Ends frames that the host does not wait for: names their pairs, and flags what does not fit.
class QueuedStage {
public:
    /// `stores`: whether the frame stores pairs. Throws OutOfMemory.
    QueuedStage(const Bodies& bodies, LaunchShape shape, std::shared_ptr<const AnswerBuffers> answer,
                bool stores);
    /// Sets the limits of the frame's other buffers; required before launch(). Throws OutOfMemory.
    void set_limits(std::vector<Limit> limits);

    /// Enqueues the end of a frame.
    void launch(const Status& status) const;
    /// The frame that launch() ends, without its origin and the memory of other stages.
    const QueuedFrame& frame() const { return frame_; }
    /// Waits, and reads the status of the last frame; nullopt if it is flagged.
    std::optional<Status::Words> read() const;

private:
    const Bodies& bodies_;
    LaunchShape shape_;
    std::uint32_t limit_count_ = 0;
    Buffer limits_;
    std::shared_ptr<const AnswerBuffers> answer_;
    QueuedFrame frame_;
    KernelOf<kernels::queued::NamePairs> name_; ///< null if no pairs are stored
    KernelOf<kernels::queued::EndFrame> end_;
};

} // namespace tandem
