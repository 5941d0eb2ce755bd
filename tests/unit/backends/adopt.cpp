// SPDX-License-Identifier: MIT
// tandem on the OpenCL context, queue and memory of a host application.
#define CL_TARGET_OPENCL_VERSION 120
#include "backends/opencl/opencl_device.h"
#include "base/error.h"
#include "tests/support/test.h"

#include <CL/cl.h>

namespace tandem {
namespace {

TEST(Adopt, WorksOnTheApplicationsQueueAndMemory) {
    cl_platform_id platform = nullptr;
    cl_device_id id = nullptr;
    ASSERT_EQ(clGetPlatformIDs(1, &platform, nullptr), CL_SUCCESS);
    ASSERT_EQ(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &id, nullptr), CL_SUCCESS);
    cl_int code = CL_SUCCESS;
    auto* context = clCreateContext(nullptr, 1, &id, nullptr, nullptr, &code);
    ASSERT_EQ(code, CL_SUCCESS);
    auto* queue = clCreateCommandQueue(context, id, 0, &code);
    ASSERT_EQ(code, CL_SUCCESS);
    std::vector<std::uint32_t> words{1, 2, 3, 4};
    auto* memory = clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, 16, words.data(), &code);
    ASSERT_EQ(code, CL_SUCCESS);
    {
        const auto device = opencl::adopt(context, id, queue);
        const StageScope scope(*device, Stage::read);
        const auto buffer = device->adopt(memory, 16, "the application's");
        EXPECT_EQ(buffer.native(), memory);
        std::vector<std::uint32_t> back(4);
        device->download(buffer, std::as_writable_bytes(std::span(back)));
        EXPECT_EQ(back, words);
        device->clear(buffer, 4);
        device->finish();
        EXPECT_EQ(device->bytes_allocated(), 0u);
    }
    // The application's objects outlive the device and contain what it wrote.
    ASSERT_EQ(clEnqueueReadBuffer(queue, memory, CL_TRUE, 0, 16, words.data(), 0, nullptr, nullptr),
              CL_SUCCESS);
    EXPECT_EQ(words, (std::vector<std::uint32_t>{0, 2, 3, 4}));
    EXPECT_EQ(clReleaseMemObject(memory), CL_SUCCESS);
    EXPECT_EQ(clReleaseCommandQueue(queue), CL_SUCCESS);
    EXPECT_EQ(clReleaseContext(context), CL_SUCCESS);
}

TEST(Adopt, RefusesQueuesThatItCannotUse) {
    cl_platform_id platform = nullptr;
    cl_device_id id = nullptr;
    ASSERT_EQ(clGetPlatformIDs(1, &platform, nullptr), CL_SUCCESS);
    ASSERT_EQ(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &id, nullptr), CL_SUCCESS);
    auto* context = clCreateContext(nullptr, 1, &id, nullptr, nullptr, nullptr);
    auto* other = clCreateContext(nullptr, 1, &id, nullptr, nullptr, nullptr);
    auto* queue = clCreateCommandQueue(context, id, 0, nullptr);
    auto* unordered = clCreateCommandQueue(context, id, CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE, nullptr);
    const auto refusal = [](auto* of, auto* device, auto* with) {
        try {
            opencl::adopt(of, device, with);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("adopted");
    };
    EXPECT_EQ(refusal(context, id, queue), "adopted");
    EXPECT_THAT(refusal(other, id, queue), testing::HasSubstr("is of another context"));
    EXPECT_THAT(refusal(context, id, static_cast<cl_command_queue>(nullptr)), testing::HasSubstr("null"));
    EXPECT_THAT(refusal(static_cast<cl_context>(nullptr), id, queue), testing::HasSubstr("null"));
    if (unordered != nullptr) { // not every device has such queues
        EXPECT_THAT(refusal(context, id, unordered), testing::HasSubstr("out-of-order"));
        clReleaseCommandQueue(unordered);
    }
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    clReleaseContext(other);
}

} // namespace
} // namespace tandem
