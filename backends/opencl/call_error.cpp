// SPDX-License-Identifier: MIT
#include "backends/opencl/call_error.h"

#include <fmt/format.h>

namespace tandem::opencl {

namespace {

std::string error_name(cl_int code) {
    static const std::map<cl_int, const char*> names{
        {CL_DEVICE_NOT_AVAILABLE, "device not available"},
        {CL_MEM_OBJECT_ALLOCATION_FAILURE, "memory allocation failure"},
        {CL_OUT_OF_RESOURCES, "out of resources"},
        {CL_OUT_OF_HOST_MEMORY, "out of host memory"},
        {CL_BUILD_PROGRAM_FAILURE, "build failure"},
        {CL_INVALID_WORK_GROUP_SIZE, "invalid work-group size"},
        {CL_INVALID_KERNEL_ARGS, "invalid kernel arguments"},
        {CL_INVALID_ARG_SIZE, "invalid argument size"},
        {CL_INVALID_BUFFER_SIZE, "invalid buffer size"},
    };
    const auto found = names.find(code);
    return found == names.end() ? fmt::format("code {}", code)
                                : fmt::format("code {}, {}", code, found->second);
}

} // namespace

void throw_call_error(const DeviceInfo& info, cl_int code, std::string_view call, std::string_view what) {
    const auto text =
        fmt::format("{} ({}): {} failed with {} while {}", info.id, info.name, call, error_name(code), what);
    if (code == CL_MEM_OBJECT_ALLOCATION_FAILURE) throw OutOfMemory(text);
    throw DeviceError(text);
}

} // namespace tandem::opencl
