// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/command_clock.h"

#include <vector>

namespace tandem::cuda {

/// Times each command by an event before and one after it. The cost of the events is part of the time: 2 to 4
/// us of a short command.
class EventClock : public CommandClock {
public:
    /// `why`: the reason why CUPTI is not used; empty when there is no CUPTI.
    EventClock(const Driver& driver, Stream stream, std::string why)
        : driver_(driver), stream_(stream), why_(std::move(why)) {}
    ~EventClock() override;

    std::string name() const override;
    bool start() override { return true; }
    void stop() override {}
    Refusal begin() override;
    Refusal end() override { return record(); }
    void drop() override { used_ = used_at_begin_; }
    std::uint64_t ticket() const override { return used_ / 2; }
    void collect() override {}
    std::pair<std::int64_t, std::int64_t> interval(std::uint64_t ticket) override;
    bool spent() const override { return false; }

private:
    Refusal record();

    const Driver& driver_;
    Stream stream_;
    std::string why_;
    std::vector<EventHandle>
        events_; ///< begin and end of each command since the last reading, then spare events
    std::size_t used_ = 0;
    std::size_t used_at_begin_ = 0; ///< used_ at the last begin(), to drop half a pair
    std::size_t read_ = 0;          ///< pairs read
};

} // namespace tandem::cuda
