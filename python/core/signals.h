// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"
#include "harness/plans/device_groups.h"

#include <atomic>
#include <chrono>
#include <nanobind/nanobind.h>
#include <thread>

namespace tandem::python {

/// Lets Python handle signals while a call works on devices without the interpreter's lock: before launches,
/// at most ten times a second. If a handler raises an exception, as that of Ctrl-C does, no device begins
/// another launch, and the call ends with that exception. Python runs handlers in its main thread alone.
class Signals {
public:
    /// At most one object may exist for a device at a time.
    explicit Signals(const DeviceGroup& devices);
    ~Signals();
    Signals(const Signals&) = delete;
    Signals& operator=(const Signals&) = delete;

    /// The result of `work`, which may launch on the devices from several threads. Throws the exception of a
    /// handler once no command is in flight.
    template<class Work>
    auto within(const Work& work) {
        try {
            return work();
        } catch (const Raised&) {
            finish();
            std::rethrow_exception(error_);
        }
    }

private:
    /// Ends the work of a thread. No error, so that nothing takes it for a failure of a device.
    struct Raised {};

    void check();
    void finish() const;

    const DeviceGroup& devices_;
    const std::thread::id caller_ = std::this_thread::get_id();
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
    std::atomic<bool> raised_ = false;
    std::exception_ptr error_; ///< nanobind::python_error, set before raised_
};

} // namespace tandem::python
