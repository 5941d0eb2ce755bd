// SPDX-License-Identifier: MIT
// The entry points of NVIDIA's driver that tandem uses, declared in this file so that a build needs no
// toolkit. A test compares them with <cuda.h> when it is installed. Names and values: CUDA Driver API
// reference, 13.0.
#pragma once

#include "backends/library.h"

#include <cstddef>
#include <string>

struct CUctx_st;
struct CUmod_st;
struct CUfunc_st;
struct CUstream_st;
struct CUevent_st;
struct CUgraph_st;
struct CUgraphExec_st;

namespace tandem::cuda {

using Result = int; ///< CUresult; 0 is success
inline constexpr Result out_of_memory = 2;
using DeviceHandle = int;
using DevicePointer = unsigned long long;
using Context = CUctx_st*;
using Module = CUmod_st*;
using Function = CUfunc_st*;
using Stream = CUstream_st*;
using EventHandle = CUevent_st*;
using Graph = CUgraph_st*;
using GraphExec = CUgraphExec_st*;

/// The values of CUdevice_attribute and CUfunction_attribute that are queried.
enum DeviceAttribute : int {
    max_threads_per_block = 1,
    max_shared_per_block = 8,
    clock_rate_khz = 13,
    multiprocessor_count = 16,
    memory_clock_rate_khz = 36,
    memory_bus_bits = 37,
    max_threads_per_multiprocessor = 39,
    capability_major = 75,
    capability_minor = 76
};
enum FunctionAttribute : int {
    function_max_threads = 0,
    function_shared_bytes = 1,
    function_private_bytes = 3,
    function_registers = 4
};

// ENTRY(symbol in the library, arguments); each returns Result.
#define TANDEM_CUDA_ENTRIES(ENTRY)                                                                           \
    ENTRY(cuInit, (unsigned))                                                                                \
    ENTRY(cuDriverGetVersion, (int*))                                                                        \
    ENTRY(cuGetErrorName, (Result, const char**))                                                            \
    ENTRY(cuGetErrorString, (Result, const char**))                                                          \
    ENTRY(cuDeviceGetCount, (int*))                                                                          \
    ENTRY(cuDeviceGet, (DeviceHandle*, int))                                                                 \
    ENTRY(cuDeviceGetName, (char*, int, DeviceHandle))                                                       \
    ENTRY(cuDeviceGetUuid_v2, (unsigned char*, DeviceHandle))                                                \
    ENTRY(cuDeviceGetAttribute, (int*, int, DeviceHandle))                                                   \
    ENTRY(cuDeviceTotalMem_v2, (std::size_t*, DeviceHandle))                                                 \
    ENTRY(cuDevicePrimaryCtxRetain, (Context*, DeviceHandle))                                                \
    ENTRY(cuDevicePrimaryCtxRelease_v2, (DeviceHandle))                                                      \
    ENTRY(cuCtxGetCurrent, (Context*))                                                                       \
    ENTRY(cuCtxSetCurrent, (Context))                                                                        \
    ENTRY(cuCtxGetDevice, (DeviceHandle*))                                                                   \
    ENTRY(cuMemGetInfo_v2, (std::size_t*, std::size_t*))                                                     \
    ENTRY(cuMemAlloc_v2, (DevicePointer*, std::size_t))                                                      \
    ENTRY(cuMemFree_v2, (DevicePointer))                                                                     \
    ENTRY(cuMemHostAlloc, (void**, std::size_t, unsigned))                                                   \
    ENTRY(cuMemFreeHost, (void*))                                                                            \
    ENTRY(cuMemcpyHtoDAsync_v2, (DevicePointer, const void*, std::size_t, Stream))                           \
    ENTRY(cuMemcpyDtoHAsync_v2, (void*, DevicePointer, std::size_t, Stream))                                 \
    ENTRY(cuMemsetD8Async, (DevicePointer, unsigned char, std::size_t, Stream))                              \
    ENTRY(cuStreamCreate, (Stream*, unsigned))                                                               \
    ENTRY(cuStreamDestroy_v2, (Stream))                                                                      \
    ENTRY(cuStreamSynchronize, (Stream))                                                                     \
    ENTRY(cuStreamWaitEvent, (Stream, EventHandle, unsigned))                                                \
    ENTRY(cuEventCreate, (EventHandle*, unsigned))                                                           \
    ENTRY(cuEventDestroy_v2, (EventHandle))                                                                  \
    ENTRY(cuEventRecord, (EventHandle, Stream))                                                              \
    ENTRY(cuEventElapsedTime, (float*, EventHandle, EventHandle))                                            \
    ENTRY(cuModuleLoadData, (Module*, const void*))                                                          \
    ENTRY(cuModuleUnload, (Module))                                                                          \
    ENTRY(cuModuleGetFunction, (Function*, Module, const char*))                                             \
    ENTRY(cuFuncGetAttribute, (int*, int, Function))                                                         \
    ENTRY(cuStreamBeginCapture_v2, (Stream, int))                                                            \
    ENTRY(cuStreamEndCapture, (Stream, Graph*))                                                              \
    ENTRY(cuStreamIsCapturing, (Stream, int*))                                                               \
    ENTRY(cuGraphInstantiateWithFlags, (GraphExec*, Graph, unsigned long long))                              \
    ENTRY(cuGraphLaunch, (GraphExec, Stream))                                                                \
    ENTRY(cuGraphExecDestroy, (GraphExec))                                                                   \
    ENTRY(cuGraphDestroy, (Graph))                                                                           \
    ENTRY(cuLaunchKernel, (Function, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned,   \
                           Stream, void**, void**))

// Optional entry points; null when the driver lacks them.
#define TANDEM_CUDA_OPTIONAL_ENTRIES(ENTRY)                                                                  \
    ENTRY(cuOccupancyMaxActiveBlocksPerMultiprocessor, (int*, Function, int, std::size_t))                   \
    ENTRY(cuProfilerStart, ())                                                                               \
    ENTRY(cuProfilerStop, ())

/// The driver's entry points.
struct Driver {
    /// Loads and initialises libcuda.so.1. Throws DeviceError: one sentence on what is missing.
    Driver();

// NOLINTNEXTLINE(bugprone-macro-parentheses): a declaration
#define TANDEM_DECLARE(name, arguments) Result(*name) arguments = nullptr;
    TANDEM_CUDA_ENTRIES(TANDEM_DECLARE)
    TANDEM_CUDA_OPTIONAL_ENTRIES(TANDEM_DECLARE) ///< null when the driver has none
#undef TANDEM_DECLARE

    Library library;
    int version = 0; ///< of the CUDA that it supports: 13000 is 13.0

    /// "CUDA_ERROR_OUT_OF_MEMORY (out of memory)"
    std::string describe(Result result) const;
};

/// "13.0" for 13000.
std::string version_text(int version);

} // namespace tandem::cuda
