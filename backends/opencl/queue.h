// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"
#include "backends/opencl/cl.h"
#include "backends/staging.h"

#include <string_view>
#include <type_traits>
#include <vector>

namespace tandem::opencl {

/// The in-order command queues of a device: one without profiling for the headline runs, and one with it for
/// the breakdown per command. Submits commands, keeps their events and waits for them. Every function may
/// throw DeviceError.
class Queue {
public:
    /// Makes its queues in `context`, which must outlive it, as must `info`.
    Queue(const DeviceInfo& info, cl_device_id device, cl_context context);
    /// Uses the queue of an application, which must outlive it, as must `info`.
    Queue(const DeviceInfo& info, cl_command_queue queue);
    /// Waits.
    ~Queue();
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;

    /// The queue that receives commands now.
    cl_command_queue active() const { return active_; }
    /// Memory for copies of uploads in flight; a wait must release it.
    Staging& staging() { return staging_; }

    /// Throws the error of an OpenCL call unless it is CL_SUCCESS. Waits before, because the handler of the
    /// error may free memory that commands in flight still use. `what` is text or a callable that makes it,
    /// called on failure only.
    template<class What>
    void check(cl_int code, std::string_view call, const What& what) {
        if (code == CL_SUCCESS) return;
        if constexpr (std::is_invocable_v<What>)
            fail(code, call, what());
        else
            fail(code, call, what);
    }

    /// Enqueues by `call`, which receives a pointer for the command's event, or null. `name` is the function
    /// that it calls; `what` is as in check(). Returns the ticket.
    template<class Call, class What>
    std::uint64_t submit(std::string_view name, const Call& call, const What& what) {
        cl_event event = nullptr;
        check(call(clocks_ == Clocks::on ? &event : nullptr), name, what);
        if (event == nullptr) return 0;
        events_.push_back(event);
        return events_.size();
    }

    /// Waits for all commands.
    void finish();
    /// Waits for the commands of an application's queue.
    void follow(cl_command_queue queue) { check(clFinish(queue), "clFinish", "waiting for another queue"); }
    /// Selects the queue with profiling, made at the first use, or the one without.
    void set_clocks(Clocks clocks);
    /// As Device::do_interval().
    std::pair<std::int64_t, std::int64_t> interval(std::uint64_t ticket);

private:
    [[noreturn]] void fail(cl_int code, std::string_view call, std::string_view what);
    cl_command_queue make_queue(cl_command_queue_properties properties);
    bool settle();

    const DeviceInfo& info_;
    cl_device_id device_ = nullptr; ///< null, like the next, with an application's queue
    cl_context context_ = nullptr;
    cl_command_queue queue_ = nullptr; ///< without profiling
    cl_command_queue timed_ = nullptr; ///< with profiling; null before the first use
    cl_command_queue active_ = nullptr;
    Clocks clocks_ = Clocks::off;
    std::vector<cl_event> events_; ///< by ticket
    Staging staging_;
};

} // namespace tandem::opencl
