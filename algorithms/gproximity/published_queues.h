// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/gproximity/queue_walker.h"

namespace tandem {

/// gProximity's walk as in the release: counters are uploaded and read back, with one wait each.
class PublishedQueueWalker final : public QueueWalker {
public:
    using QueueWalker::QueueWalker;

private:
    void do_clear_idle() override;
    /// As in the release, reads the queues' counts after every launch to detect full queues.
    void do_after_launch() override;
};

} // namespace tandem
