// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/gproximity/queue_walker.h"

namespace tandem {

/// gProximity's walk as the release drove it: counters uploaded and read, a wait each.
class PublishedQueueWalker final : public QueueWalker {
public:
    using QueueWalker::QueueWalker;

private:
    void do_clear_idle() override;
    /// The release reads the queues' counts after every launch, to look for full ones.
    void do_after_launch() override;
};

} // namespace tandem
