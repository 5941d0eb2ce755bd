// SPDX-License-Identifier: MIT
#include "algorithms/gproximity/published_queues.h"

namespace tandem {

void PublishedQueueWalker::do_clear_idle() {
    const std::uint32_t zero = 0;
    device().upload(idle(), std::as_bytes(std::span(&zero, 1)), 0, true);
}

void PublishedQueueWalker::do_after_launch() {
    const StageScope scope(device(), Stage::read);
    std::vector<std::uint32_t> read(sizes().groups);
    device().download(counts(), std::as_writable_bytes(std::span(read)));
}

} // namespace tandem
