// SPDX-License-Identifier: MIT
// A program that owns an OpenCL context and queue, and lets tandem find candidate pairs in them. tandem works
// on that queue, after the program's own commands. Prints the number of pairs.
#define CL_TARGET_OPENCL_VERSION 120
#include "find_pairs.h"

#include <tandem/backends/opencl/opencl_device.h>

#include <CL/cl.h>
#include <cstdio>
#include <vector>

namespace {

constexpr std::size_t bytes = std::size_t{1} << 20;

bool check(bool good, const char* what) {
    if (!good) std::fprintf(stderr, "opencl_queue: %s\n", what);
    return good;
}

/// Whether tandem reads the application's memory only after the application's own command on the queue.
bool follows(tandem::Device& device, cl_command_queue queue, cl_mem memory) {
    const cl_uchar value = 0x5a;
    if (clEnqueueFillBuffer(queue, memory, &value, 1, 0, bytes, 0, nullptr, nullptr) != CL_SUCCESS)
        return false;
    const auto adopted = device.adopt(memory, bytes, "the application's");
    std::vector<std::byte> back(bytes);
    const tandem::StageScope scope(device, tandem::Stage::read);
    device.download(adopted, back);
    for (const auto byte : back)
        if (byte != std::byte{value}) return false;
    return true;
}

bool run(cl_context context, cl_device_id id, cl_command_queue queue, cl_mem memory) {
    const auto device = tandem::opencl::adopt(context, id, queue);
    bool good = check(follows(*device, queue, memory), "tandem does not follow the application's commands");
    const auto count = candidate_pairs(*device);
    std::printf("%llu candidate pairs\n", static_cast<unsigned long long>(count));
    good &= check(count > 0, "no pairs");
    good &= check(device->bytes_allocated() == 0, "the session left memory behind");
    return good & check(device->finish().events.empty(), "commands were recorded without a request");
}

} // namespace

int main() {
    cl_platform_id platform = nullptr;
    cl_device_id id = nullptr;
    cl_int code = clGetPlatformIDs(1, &platform, nullptr);
    if (code == CL_SUCCESS) code = clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &id, nullptr);
    if (!check(code == CL_SUCCESS, "no device")) return 1;
    auto* context = clCreateContext(nullptr, 1, &id, nullptr, nullptr, &code);
    auto* queue = clCreateCommandQueue(context, id, 0, &code);
    auto* memory = clCreateBuffer(context, CL_MEM_READ_WRITE, bytes, nullptr, &code);
    bool good = run(context, id, queue, memory);
    // Objects of the application must remain valid after the device that adopted them.
    good &= check(clFinish(queue) == CL_SUCCESS, "the queue is gone");
    good &= check(clReleaseMemObject(memory) == CL_SUCCESS, "the memory is gone");
    good &= check(clReleaseCommandQueue(queue) == CL_SUCCESS, "the queue is gone");
    good &= check(clReleaseContext(context) == CL_SUCCESS, "the context is gone");
    return good ? 0 : 1;
}
