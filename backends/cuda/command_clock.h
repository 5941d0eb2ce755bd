// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/driver.h"

#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

namespace tandem::cuda {

/// Times the commands of one device while clocks are on. The device's context must be current in every call.
class CommandClock {
public:
    /// An error of the driver.
    struct Refusal {
        Result code = 0; ///< 0: none
        std::string_view call;
    };

    CommandClock() = default;
    virtual ~CommandClock() = default;
    CommandClock(const CommandClock&) = delete;
    CommandClock& operator=(const CommandClock&) = delete;

    /// As Device::clock().
    virtual std::string name() const = 0;

    /// Starts timing. False: this clock can never be used.
    virtual bool start() = 0;
    virtual void stop() = 0;

    /// Called before and after a command is passed to the driver.
    virtual Refusal begin() = 0;
    virtual Refusal end() = 0;
    /// Replaces end() when the command was refused.
    virtual void drop() = 0;
    /// The ticket of the command that ended last, from 1 on.
    virtual std::uint64_t ticket() const = 0;

    /// Called after every command has run.
    virtual void collect() = 0;
    /// As Device::do_interval(), in nanoseconds; {-1, -1} when unknown. Begins count from the first command
    /// since all tickets were last released.
    virtual std::pair<std::int64_t, std::int64_t> interval(std::uint64_t ticket) = 0;
    /// Whether it has failed and all its tickets are released: another clock must replace it.
    virtual bool spent() const = 0;
};

/// Starts `clock` and returns it. If it is null or cannot start, returns a started replacement: CUPTI's
/// records if available, else CUDA events.
std::unique_ptr<CommandClock> started_clock(std::unique_ptr<CommandClock> clock, const Driver& driver,
                                            Stream stream);

/// The name() to expect before the first start.
std::string expected_clock(const Driver& driver);

} // namespace tandem::cuda
