// SPDX-License-Identifier: MIT
// The entry points and records of NVIDIA's profiling library that tandem uses, declared in this file so that
// a build needs no toolkit. A test compares them with <cupti.h> when it is installed. Names and values: CUPTI
// API reference, 13.0. Only the first fields of a record are declared; their offsets are the same since CUDA
// 11.2.
#pragma once

#include "backends/library.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct CUctx_st;
struct CUpti_Subscriber_st;

namespace tandem::cuda {

using CuptiResult = int; ///< CUptiResult; 0 is success
using CuptiSubscriber = CUpti_Subscriber_st*;

/// The values of CUpti_ActivityKind that are recorded.
enum CuptiKind : int {
    cupti_memcpy = 1,
    cupti_memset = 2,
    cupti_driver = 4, ///< driver calls; external correlation needs them
    cupti_kernel = 10,
    cupti_external_correlation = 39
};
enum CuptiExternal : int { cupti_custom = 3 }; ///< CUPTI_EXTERNAL_CORRELATION_KIND_CUSTOM0

/// The first field of every record.
struct alignas(8) CuptiRecord {
    CuptiKind kind = {};
};

/// A completed kernel. Times in nanoseconds, 0 when unknown.
struct CuptiKernel {
    CuptiKind kind = cupti_kernel;
    unsigned char configuration[12] = {};
    std::uint64_t start = 0, end = 0, completed = 0;
    std::uint32_t device = 0, context = 0, stream = 0;
    std::int32_t grid[3] = {}, block[3] = {};
    std::int32_t static_shared = 0, dynamic_shared = 0;
    std::uint32_t local = 0, local_total = 0;
    std::uint32_t correlation = 0; ///< id of the driver call
};

/// A completed copy or clear; the records of both have these fields at the same offsets.
struct CuptiTransfer {
    CuptiKind kind = cupti_memcpy;
    std::uint32_t what = 0; ///< kinds of copy and memory; value of a clear
    std::uint64_t bytes = 0;
    std::uint64_t start = 0, end = 0;
    std::uint32_t device = 0, context = 0, stream = 0;
    std::uint32_t correlation = 0;
};

/// Maps a driver call to the caller's own id.
struct CuptiCorrelation {
    CuptiKind kind = cupti_external_correlation;
    CuptiExternal whose = cupti_custom;
    std::uint64_t id = 0;
    std::uint32_t correlation = 0;
};

using CuptiCallback = void (*)(void* data, int domain, std::uint32_t callback, const void* call);
using CuptiRequested = void (*)(unsigned char** buffer, std::size_t* bytes, std::size_t* most_records);
using CuptiCompleted = void (*)(CUctx_st*, std::uint32_t stream, unsigned char* buffer, std::size_t bytes,
                                std::size_t valid);

// ENTRY(symbol in the library, arguments); each returns CuptiResult.
#define TANDEM_CUPTI_ENTRIES(ENTRY)                                                                          \
    ENTRY(cuptiGetVersion, (std::uint32_t*))                                                                 \
    ENTRY(cuptiSubscribe, (CuptiSubscriber*, CuptiCallback, void*))                                          \
    ENTRY(cuptiUnsubscribe, (CuptiSubscriber))                                                               \
    ENTRY(cuptiFinalize, ())                                                                                 \
    ENTRY(cuptiActivityRegisterCallbacks, (CuptiRequested, CuptiCompleted))                                  \
    ENTRY(cuptiActivityEnable, (CuptiKind))                                                                  \
    ENTRY(cuptiActivityDisable, (CuptiKind))                                                                 \
    ENTRY(cuptiActivityFlushAll, (std::uint32_t))                                                            \
    ENTRY(cuptiActivityGetNextRecord, (unsigned char*, std::size_t, CuptiRecord**))                          \
    ENTRY(cuptiActivityPushExternalCorrelationId, (CuptiExternal, std::uint64_t))                            \
    ENTRY(cuptiActivityPopExternalCorrelationId, (CuptiExternal, std::uint64_t*))

/// The library's entry points.
struct Cupti {
// NOLINTNEXTLINE(bugprone-macro-parentheses): a declaration
#define TANDEM_DECLARE(name, arguments) CuptiResult(*name) arguments = nullptr;
    TANDEM_CUPTI_ENTRIES(TANDEM_DECLARE)
#undef TANDEM_DECLARE

    std::string version; ///< "13.0", or "API 26" for versions before 13.0
};

/// Opens the first of `names` that loads; null when none does. Throws DeviceError with a short reason when
/// the library cannot be used.
std::unique_ptr<const Cupti> open_cupti(std::span<const std::string> names);

/// The libraries to try with a driver for that CUDA (13000 is 13.0): $TANDEM_CUPTI, or none if it is empty.
/// By default those of no newer major version.
std::vector<std::string> cupti_candidates(int driver_version);

} // namespace tandem::cuda
