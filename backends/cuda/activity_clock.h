// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/activity.h"
#include "backends/cuda/command_clock.h"

#include <vector>

namespace tandem::cuda {

/// Times commands by CUPTI's activity records. A command's time includes nothing else.
class ActivityClock : public CommandClock {
public:
    /// `records` must outlive it.
    explicit ActivityClock(Activity& records) : records_(records) {}
    ~ActivityClock() override;

    std::string name() const override { return records_.name(); }
    bool start() override;
    void stop() override;
    Refusal begin() override;
    Refusal end() override;
    void drop() override;
    std::uint64_t ticket() const override { return ids_.size(); }
    void collect() override;
    std::pair<std::int64_t, std::int64_t> interval(std::uint64_t ticket) override;
    bool spent() const override { return ids_.empty() && !records_.failure().empty(); }

private:
    Activity& records_;
    bool started_ = false;
    std::vector<std::uint64_t> ids_;                   ///< by ticket - 1
    std::vector<std::optional<Activity::Span>> spans_; ///< of the ids collected so far, in order
    std::size_t read_ = 0;
};

} // namespace tandem::cuda
