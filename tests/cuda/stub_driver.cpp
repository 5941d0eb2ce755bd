// SPDX-License-Identifier: MIT
// A libcuda.so.1 without a GPU: memory is the host's, kernels do nothing. What goes wrong is chosen by
// variables: STUB_INIT (code of cuInit), STUB_VERSION, STUB_MEMORY (bytes there are), STUB_FAULT (launches
// fault).
#include "backends/cuda/driver.h"

#include <cstdlib>
#include <cstring>
#include <map>

using namespace tandem::cuda;

namespace {

long number(const char* name, long otherwise) {
    const auto* text = std::getenv(name);
    return text != nullptr ? std::atol(text) : otherwise;
}

bool launched = false;
std::size_t in_use = 0;
std::map<DevicePointer, std::size_t> sizes;

std::size_t memory() { return static_cast<std::size_t>(number("STUB_MEMORY", 1L << 32)); }

template<class Handle>
Result make(Handle* handle) {
    static char something;
    *handle = reinterpret_cast<Handle>(&something);
    return 0;
}

} // namespace

extern "C" {
Result cuInit(unsigned) { return static_cast<Result>(number("STUB_INIT", 0)); }
Result cuDriverGetVersion(int* version) {
    *version = static_cast<int>(number("STUB_VERSION", 13000));
    return 0;
}
Result cuGetErrorName(Result code, const char** name) {
    static const std::map<Result, const char*> names{
        {2, "CUDA_ERROR_OUT_OF_MEMORY"}, {100, "CUDA_ERROR_NO_DEVICE"}, {700, "CUDA_ERROR_ILLEGAL_ADDRESS"}};
    *name = names.contains(code) ? names.at(code) : nullptr;
    return *name != nullptr ? 0 : 1;
}
Result cuGetErrorString(Result, const char** text) {
    *text = "the stub's words";
    return 0;
}
Result cuDeviceGetCount(int* count) {
    *count = 1;
    return 0;
}
Result cuDeviceGet(DeviceHandle* device, int index) {
    *device = index;
    return 0;
}
Result cuDeviceGetName(char* name, int size, DeviceHandle) {
    std::strncpy(name, "Stub GPU", static_cast<std::size_t>(size));
    return 0;
}
Result cuDeviceGetUuid_v2(unsigned char* uuid, DeviceHandle) {
    std::memset(uuid, 0x5a, 16);
    return 0;
}
Result cuDeviceGetAttribute(int* value, int what, DeviceHandle) {
    static const std::map<int, int> values{{max_threads_per_block, 1024},
                                           {max_shared_per_block, 49152},
                                           {multiprocessor_count, 2},
                                           {capability_major, 9},
                                           {capability_minor, 0}};
    *value = values.at(what);
    return 0;
}
Result cuDeviceTotalMem_v2(std::size_t* bytes, DeviceHandle) {
    *bytes = memory();
    return 0;
}
Result cuDevicePrimaryCtxRetain(Context* context, DeviceHandle) { return make(context); }
Result cuDevicePrimaryCtxRelease_v2(DeviceHandle) { return 0; }
Result cuCtxSetCurrent(Context) { return 0; }
Result cuCtxGetDevice(DeviceHandle* device) {
    *device = 0;
    return 0;
}
Result cuMemGetInfo_v2(std::size_t* free, std::size_t* total) {
    *total = memory();
    *free = *total - in_use;
    return 0;
}
Result cuMemAlloc_v2(DevicePointer* pointer, std::size_t bytes) {
    if (in_use + bytes > memory()) return 2;
    *pointer = reinterpret_cast<DevicePointer>(std::calloc(1, bytes));
    sizes[*pointer] = bytes;
    in_use += bytes;
    return 0;
}
Result cuMemFree_v2(DevicePointer pointer) {
    in_use -= sizes.at(pointer);
    sizes.erase(pointer);
    std::free(reinterpret_cast<void*>(pointer));
    return 0;
}
Result cuMemHostAlloc(void** memory, std::size_t bytes, unsigned) {
    *memory = std::malloc(bytes);
    return 0;
}
Result cuMemFreeHost(void* memory) {
    std::free(memory);
    return 0;
}
Result cuMemcpyHtoDAsync_v2(DevicePointer to, const void* from, std::size_t bytes, Stream) {
    std::memcpy(reinterpret_cast<void*>(to), from, bytes);
    return 0;
}
Result cuMemcpyDtoHAsync_v2(void* to, DevicePointer from, std::size_t bytes, Stream) {
    std::memcpy(to, reinterpret_cast<const void*>(from), bytes);
    return 0;
}
Result cuMemsetD8Async(DevicePointer to, unsigned char value, std::size_t bytes, Stream) {
    std::memset(reinterpret_cast<void*>(to), value, bytes);
    return 0;
}
Result cuStreamCreate(Stream* stream, unsigned) { return make(stream); }
Result cuStreamDestroy_v2(Stream) { return 0; }
Result cuStreamSynchronize(Stream) { return launched && number("STUB_FAULT", 0) != 0 ? 700 : 0; }
Result cuEventCreate(EventHandle* event, unsigned) { return make(event); }
Result cuEventDestroy_v2(EventHandle) { return 0; }
Result cuEventRecord(EventHandle, Stream) { return 0; }
Result cuEventElapsedTime(float* ms, EventHandle, EventHandle) {
    *ms = 0.001f;
    return 0;
}
Result cuModuleLoadData(Module* module, const void*) { return make(module); }
Result cuModuleUnload(Module) { return 0; }
Result cuModuleGetFunction(Function* function, Module, const char*) { return make(function); }
Result cuFuncGetAttribute(int* value, int, Function) {
    *value = 1;
    return 0;
}
#ifndef STUB_OLD
Result cuLaunchKernel(Function, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, Stream,
                      void**, void**) {
    launched = true;
    return 0;
}
#endif
}
