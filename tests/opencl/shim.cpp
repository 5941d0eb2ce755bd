// SPDX-License-Identifier: MIT
// Preloaded or linked before the OpenCL loader. It makes one call fail and keeps enqueued commands in flight
// until the host waits, as a slow device would. The source of a write in flight must not change: the shim
// compares it when the host waits and when the process ends, and aborts on a difference. SHIM_CALL,
// SHIM_CODE: as in opencl_shim_fail(); SHIM_COUNT: a file for the number of calls.
// SHIM_BUILDS: the first builds fail.
#define CL_TARGET_OPENCL_VERSION 120
#include "tests/opencl/shim.h"

#include <CL/cl.h>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <map>
#include <vector>

namespace {

struct Write {
    const unsigned char* from;
    std::size_t bytes;
    unsigned long sum;
};

/// Commands of one queue in flight, behind a barrier that waits for `gate`.
struct Queue {
    cl_event gate = nullptr;
    std::vector<Write> writes;
};

unsigned long number(const char* name) {
    const auto* text = std::getenv(name);
    return text != nullptr ? std::strtoul(text, nullptr, 10) : 0;
}

/// Never destroyed: it is checked when the process ends.
struct State {
    unsigned long fails = number("SHIM_CALL");
    int code =
        std::getenv("SHIM_CODE") != nullptr ? std::atoi(std::getenv("SHIM_CODE")) : CL_OUT_OF_RESOURCES;
    unsigned long calls = 0;
    std::size_t reported_group_size = 0; ///< reported maximum work-group size of every kernel, if not 0
    unsigned long failing_builds = number("SHIM_BUILDS"); ///< number of builds that still fail
    bool has_started = false;                             ///< a command has been enqueued
    std::map<cl_command_queue, Queue> queues;
    Queue released; ///< in flight on released queues
};

State& state() {
    static auto* const all = new State;
    return *all;
}

template<class Function>
Function* real(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}
#define REAL(name) real<decltype(name)>(#name)

/// Whether this call is the failing one.
bool fails() { return state().has_started && ++state().calls == state().fails; }

unsigned long sum_of(const unsigned char* from, std::size_t bytes) {
    unsigned long sum = 0;
    for (std::size_t i = 0; i < bytes; ++i) sum = sum * 31 + from[i];
    return sum;
}

void check_writes(const Queue& queue) {
    for (const auto& write : queue.writes) {
        if (sum_of(write.from, write.bytes) == write.sum) continue;
        std::fprintf(stderr, "shim: the source of a write in flight has changed\n");
        std::abort();
    }
}

/// The first command of a queue is a barrier that waits for the gate.
void begin(cl_command_queue queue) {
    state().has_started = true;
    auto& own = state().queues[queue];
    if (own.gate != nullptr) return;
    cl_context context = nullptr;
    clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof context, &context, nullptr);
    own.gate = clCreateUserEvent(context, nullptr);
    clEnqueueBarrierWithWaitList(queue, 1, &own.gate, nullptr);
}

/// The host waits: all commands may run.
void open(cl_command_queue queue) {
    auto& own = state().queues[queue];
    check_writes(own);
    own.writes.clear();
    if (own.gate == nullptr) return;
    clSetUserEventStatus(own.gate, CL_COMPLETE);
    clReleaseEvent(own.gate);
    own.gate = nullptr;
}

struct AtEnd {
    ~AtEnd() {
        check_writes(state().released);
        for (const auto& [queue, own] : state().queues) check_writes(own);
        const auto* file = std::getenv("SHIM_COUNT");
        if (file == nullptr) return;
        auto* out = std::fopen(file, "w");
        std::fprintf(out, "%lu\n", state().calls);
        std::fclose(out);
    }
} at_end;

template<class Object>
Object* failed(cl_int* code) {
    *code = state().code;
    return nullptr;
}

} // namespace

extern "C" {

void opencl_shim_fail(unsigned long call, int code) {
    state().fails = call;
    state().code = code;
    state().calls = 0;
    state().has_started = true;
}
void opencl_shim_fail_builds(unsigned long count) {
    state().failing_builds = count;
    state().code = CL_BUILD_PROGRAM_FAILURE;
}
void opencl_shim_report_group_size(unsigned long group_size) { state().reported_group_size = group_size; }
unsigned long opencl_shim_calls() { return state().calls; }

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes, void* host, cl_int* code) {
    if (fails()) return failed<_cl_mem>(code);
    return REAL(clCreateBuffer)(context, flags, bytes, host, code);
}
cl_program clCreateProgramWithSource(cl_context context, cl_uint count, const char** texts,
                                     const size_t* sizes, cl_int* code) {
    if (fails()) return failed<_cl_program>(code);
    return REAL(clCreateProgramWithSource)(context, count, texts, sizes, code);
}
cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                      void(CL_CALLBACK* notify)(cl_program, void*), void* data) {
    if (fails()) state().failing_builds = 2; // the caller tries a second time
    if (state().failing_builds > 0) {
        --state().failing_builds;
        return state().code;
    }
    return REAL(clBuildProgram)(program, count, devices, options, notify, data);
}
cl_kernel clCreateKernel(cl_program program, const char* name, cl_int* code) {
    if (fails()) return failed<_cl_kernel>(code);
    return REAL(clCreateKernel)(program, name, code);
}
cl_int clGetKernelWorkGroupInfo(cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info what,
                                size_t bytes, void* to, size_t* needed) {
    const auto code = REAL(clGetKernelWorkGroupInfo)(kernel, device, what, bytes, to, needed);
    if (what == CL_KERNEL_WORK_GROUP_SIZE && state().reported_group_size != 0 && to != nullptr)
        *static_cast<size_t*>(to) = state().reported_group_size;
    return code;
}
cl_int clSetKernelArg(cl_kernel kernel, cl_uint index, size_t bytes, const void* value) {
    if (index == 0 && fails()) return state().code; // one failure for all arguments of a launch
    return REAL(clSetKernelArg)(kernel, index, bytes, value);
}
cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                            size_t bytes, const void* from, cl_uint count, const cl_event* list,
                            cl_event* event) {
    begin(queue);
    if (fails()) return state().code;
    const auto* text = static_cast<const unsigned char*>(from);
    if (blocking != CL_FALSE)
        open(queue);
    else
        state().queues[queue].writes.push_back({text, bytes, sum_of(text, bytes)});
    return REAL(clEnqueueWriteBuffer)(queue, buffer, blocking, offset, bytes, from, count, list, event);
}
cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                           size_t bytes, void* to, cl_uint count, const cl_event* list, cl_event* event) {
    begin(queue);
    if (fails()) return state().code;
    if (blocking != CL_FALSE) open(queue);
    return REAL(clEnqueueReadBuffer)(queue, buffer, blocking, offset, bytes, to, count, list, event);
}
cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer, const void* pattern, size_t size,
                           size_t offset, size_t bytes, cl_uint count, const cl_event* list,
                           cl_event* event) {
    begin(queue);
    if (fails()) return state().code;
    return REAL(clEnqueueFillBuffer)(queue, buffer, pattern, size, offset, bytes, count, list, event);
}
cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                              const size_t* offset, const size_t* global, const size_t* local, cl_uint count,
                              const cl_event* list, cl_event* event) {
    begin(queue);
    if (fails()) return state().code;
    return REAL(clEnqueueNDRangeKernel)(queue, kernel, dimensions, offset, global, local, count, list, event);
}
cl_int clFinish(cl_command_queue queue) {
    if (fails()) return state().code;
    open(queue);
    return REAL(clFinish)(queue);
}
cl_int clReleaseCommandQueue(cl_command_queue queue) {
    auto& writes = state().queues[queue].writes;
    state().released.writes.insert(state().released.writes.end(), writes.begin(), writes.end());
    state().queues.erase(queue);
    return REAL(clReleaseCommandQueue)(queue);
}
}
