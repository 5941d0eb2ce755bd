// SPDX-License-Identifier: MIT
#include "backends/cuda/event_clock.h"

#include <fmt/format.h>

namespace tandem::cuda {

EventClock::~EventClock() {
    for (auto* event : events_) driver_.cuEventDestroy_v2(event);
}

std::string EventClock::name() const {
    return why_.empty() ? "CUDA events" : fmt::format("CUDA events (CUPTI: {})", why_);
}

CommandClock::Refusal EventClock::begin() {
    used_at_begin_ = used_;
    return record();
}

CommandClock::Refusal EventClock::record() {
    if (used_ == events_.size()) {
        EventHandle event = nullptr;
        if (const auto code = driver_.cuEventCreate(&event, 0); code != 0) return {code, "cuEventCreate"};
        events_.push_back(event);
    }
    const auto code = driver_.cuEventRecord(events_[used_], stream_);
    if (code == 0) ++used_;
    return {code, "cuEventRecord"};
}

std::pair<std::int64_t, std::int64_t> EventClock::interval(std::uint64_t ticket) {
    float begin = 0;
    float length = 0;
    auto* const first = events_.at(2 * ticket - 2);
    auto* const last = events_.at(2 * ticket - 1);
    const bool known = driver_.cuEventElapsedTime(&begin, events_.front(), first) == 0
                       && driver_.cuEventElapsedTime(&length, first, last) == 0 && length >= 0;
    if (++read_ == used_ / 2) used_ = read_ = 0;
    if (!known) return {-1, -1};
    const auto nanoseconds = [](float ms) {
        return static_cast<std::int64_t>(static_cast<double>(ms) * 1e6);
    };
    return {nanoseconds(begin), nanoseconds(length)};
}

} // namespace tandem::cuda
