// SPDX-License-Identifier: MIT
#include "backends/opencl/queue.h"

#include "backends/opencl/call_error.h"

#include <new>

namespace tandem::opencl {

namespace {

/// Memory for copies of uploads in flight; uploads beyond it wait.
constexpr std::size_t max_staged = std::size_t{64} << 20;

Staging::Source host_memory() {
    return {[](std::size_t bytes) { return new (std::nothrow) std::byte[bytes]; },
            [](std::byte* memory) { delete[] memory; }};
}

} // namespace

Queue::Queue(const DeviceInfo& info, cl_device_id device, cl_context context)
    : info_(info), device_(device), context_(context), staging_(host_memory(), max_staged) {
    queue_ = active_ = make_queue(0);
}

Queue::Queue(const DeviceInfo& info, cl_command_queue queue)
    : info_(info), queue_(queue), timed_(queue), active_(queue), staging_(host_memory(), max_staged) {}

Queue::~Queue() {
    // Commands in flight read staged memory. If the wait fails, the memory is leaked, not freed.
    if (!settle()) staging_.abandon();
    for (auto* event : events_)
        if (event) clReleaseEvent(event);
    if (context_ == nullptr) return; // the queue is the application's
    if (timed_) clReleaseCommandQueue(timed_);
    clReleaseCommandQueue(queue_);
}

/// Waits until nothing is in flight; false when the wait fails.
bool Queue::settle() {
    if (active_ == nullptr) return true;
    if (clFinish(active_) != CL_SUCCESS) return false;
    staging_.release();
    return true;
}

void Queue::fail(cl_int code, std::string_view call, std::string_view what) {
    settle();
    throw_call_error(info_, code, call, what);
}

cl_command_queue Queue::make_queue(cl_command_queue_properties properties) {
    cl_int code = CL_SUCCESS;
    auto* queue = clCreateCommandQueue(context_, device_, properties, &code);
    check(code, "clCreateCommandQueue", "opening the device");
    return queue;
}

void Queue::finish() {
    check(clFinish(active_), "clFinish", "waiting");
    staging_.release();
}

void Queue::set_clocks(Clocks clocks) {
    if (clocks == Clocks::on && timed_ == nullptr) timed_ = make_queue(CL_QUEUE_PROFILING_ENABLE);
    active_ = clocks == Clocks::on ? timed_ : queue_;
    clocks_ = clocks;
}

std::pair<std::int64_t, std::int64_t> Queue::interval(std::uint64_t ticket) {
    auto*& event = events_.at(ticket - 1);
    cl_ulong begin = 0;
    cl_ulong end = 0;
    const bool known =
        clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof(begin), &begin, nullptr)
            == CL_SUCCESS
        && clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof(end), &end, nullptr) == CL_SUCCESS
        && end >= begin;
    clReleaseEvent(event);
    event = nullptr;
    if (ticket == events_.size()) events_.clear();
    if (!known) return {-1, -1};
    return {static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end - begin)};
}

} // namespace tandem::opencl
