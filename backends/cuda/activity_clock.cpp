// SPDX-License-Identifier: MIT
#include "backends/cuda/activity_clock.h"

#include <algorithm>

namespace tandem::cuda {

ActivityClock::~ActivityClock() {
    for (auto id = spans_.size(); id < ids_.size(); ++id) records_.take(ids_[id]);
    ActivityClock::stop();
}

bool ActivityClock::start() {
    if (!started_) started_ = records_.start();
    return started_ && records_.failure().empty();
}

void ActivityClock::stop() {
    if (std::exchange(started_, false)) records_.stop();
}

CommandClock::Refusal ActivityClock::begin() {
    ids_.push_back(records_.begin_command());
    return {};
}

CommandClock::Refusal ActivityClock::end() {
    records_.end_command(ids_.back());
    return {};
}

void ActivityClock::drop() {
    records_.end_command(ids_.back());
    records_.take(ids_.back());
    ids_.pop_back();
}

/// When CUPTI reports success but makes no record at all, CUDA events must replace it.
void ActivityClock::collect() {
    const auto from = static_cast<std::ptrdiff_t>(spans_.size());
    if (spans_.size() == ids_.size()) return;
    records_.collect();
    for (auto id = spans_.size(); id < ids_.size(); ++id) spans_.push_back(records_.take(ids_[id]));
    if (std::none_of(spans_.begin() + from, spans_.end(), [](const auto& span) { return span.has_value(); }))
        records_.fail("it made no records");
}

std::pair<std::int64_t, std::int64_t> ActivityClock::interval(std::uint64_t ticket) {
    const auto span = spans_.at(ticket - 1);
    // Commands run in order, so the first known span is the origin.
    const auto first =
        std::find_if(spans_.begin(), spans_.end(), [](const auto& s) { return s.has_value(); });
    const auto origin = first != spans_.end() ? (*first)->begin : 0;
    if (++read_ == ids_.size()) {
        read_ = 0;
        ids_.clear();
        spans_.clear();
    }
    if (!span) return {-1, -1};
    return {span->begin - origin, span->end - span->begin};
}

} // namespace tandem::cuda
