// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/driver.h"

#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

namespace tandem::cuda {

/// Tells when the commands of one device ran, while clocks are on. Every call is made with the device's
/// context current.
class CommandClock {
public:
    /// What the driver refused.
    struct Refusal {
        Result code = 0; ///< 0: nothing
        std::string_view call;
    };

    CommandClock() = default;
    virtual ~CommandClock() = default;
    CommandClock(const CommandClock&) = delete;
    CommandClock& operator=(const CommandClock&) = delete;

    /// As Device::clock().
    virtual std::string name() const = 0;

    /// Clocks are on from here on; false: not by this one, ever.
    virtual bool start() = 0;
    virtual void stop() = 0;

    /// Before and after a command is told to the driver.
    virtual Refusal begin() = 0;
    virtual Refusal end() = 0;
    /// In place of end(): the command was refused.
    virtual void drop() = 0;
    /// Of the command that ended last, from 1 on.
    virtual std::uint64_t ticket() const = 0;

    /// Every command has run.
    virtual void collect() = 0;
    /// As Device::do_interval(): nanoseconds, begins counted from the first command since the last time that
    /// all tickets were released; {-1, -1} when not known.
    virtual std::pair<std::int64_t, std::int64_t> interval(std::uint64_t ticket) = 0;
    /// It has failed, and all its tickets are released: another one has to go on.
    virtual bool spent() const = 0;
};

/// `clock`, or one in its place where it is none or cannot: by CUPTI's records where there is CUPTI, by
/// events otherwise. It has been started.
std::unique_ptr<CommandClock> started_clock(std::unique_ptr<CommandClock> clock, const Driver& driver,
                                            Stream stream);

/// What name() will be, as far as that is known before the first start.
std::string expected_clock(const Driver& driver);

} // namespace tandem::cuda
