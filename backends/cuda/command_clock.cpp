// SPDX-License-Identifier: MIT
#include "backends/cuda/command_clock.h"

#include "backends/cuda/activity_clock.h"
#include "backends/cuda/event_clock.h"

namespace tandem::cuda {

std::unique_ptr<CommandClock> started_clock(std::unique_ptr<CommandClock> clock, const Driver& driver,
                                            Stream stream) {
    auto& records = activity(driver.version);
    if (!clock) clock = std::make_unique<ActivityClock>(records);
    if (clock->start()) return clock;
    clock = std::make_unique<EventClock>(driver, stream, records.failure());
    clock->start();
    return clock;
}

std::string expected_clock(const Driver& driver) {
    return cupti_candidates(driver.version).empty() ? "CUDA events" : "CUPTI activity records or CUDA events";
}

} // namespace tandem::cuda
