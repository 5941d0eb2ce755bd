// SPDX-License-Identifier: MIT
// NVRTC, CUDA's compiler at run time. It needs no driver and no GPU. Names: NVRTC documentation, 13.0.
#pragma once

#include "backends/cuda/image_cache.h"
#include "backends/device.h"
#include "backends/library.h"

#include <vector>

struct _nvrtcProgram; // NOLINT(bugprone-reserved-identifier): NVIDIA's

namespace tandem::cuda {

using NvrtcResult = int; ///< nvrtcResult; 0 is success
using Program = _nvrtcProgram*;

// ENTRY(symbol in the library, arguments); each returns NvrtcResult.
#define TANDEM_NVRTC_ENTRIES(ENTRY)                                                                          \
    ENTRY(nvrtcVersion, (int*, int*))                                                                        \
    ENTRY(nvrtcGetNumSupportedArchs, (int*))                                                                 \
    ENTRY(nvrtcGetSupportedArchs, (int*))                                                                    \
    ENTRY(nvrtcCreateProgram,                                                                                \
          (Program*, const char*, const char*, int, const char* const*, const char* const*))                 \
    ENTRY(nvrtcDestroyProgram, (Program*))                                                                   \
    ENTRY(nvrtcCompileProgram, (Program, int, const char* const*))                                           \
    ENTRY(nvrtcGetProgramLogSize, (Program, std::size_t*))                                                   \
    ENTRY(nvrtcGetProgramLog, (Program, char*))                                                              \
    ENTRY(nvrtcGetPTXSize, (Program, std::size_t*))                                                          \
    ENTRY(nvrtcGetPTX, (Program, char*))                                                                     \
    ENTRY(nvrtcGetCUBINSize, (Program, std::size_t*))                                                        \
    ENTRY(nvrtcGetCUBIN, (Program, char*))

class Nvrtc {
public:
    /// Loads $TANDEM_NVRTC, or the newest NVRTC whose major version is at most that of `driver_version` (0:
    /// any). Throws DeviceError that names the libraries it looked for. `cache`: the folder for images, by
    /// default $TANDEM_KERNEL_CACHE; empty: none.
    explicit Nvrtc(int driver_version = 0, std::optional<std::filesystem::path> cache = std::nullopt);

    int version() const { return version_; } ///< 13000 is 13.0
    const std::string& library() const { return library_.name(); }
    /// Compute capabilities that it supports, as 90 for 9.0, ascending.
    const std::vector<int>& architectures() const { return architectures_; }

    /// Compiles for compute capability `architecture`: machine code if NVRTC supports it, else PTX of the
    /// newest lower one. An image in the cache is returned unchanged. Throws DeviceError with the log.
    Image compile(const KernelSource& source, const Defines& defines, int architecture,
                  bool ptx = false) const;

private:
// NOLINTNEXTLINE(bugprone-macro-parentheses): a declaration
#define TANDEM_DECLARE(name, arguments) NvrtcResult(*name) arguments = nullptr;
    TANDEM_NVRTC_ENTRIES(TANDEM_DECLARE)
#undef TANDEM_DECLARE

    Image compile_uncached(const KernelSource& source, const std::vector<std::string>& options,
                           bool machine_code, std::string target) const;

    Library library_;
    ImageCache cache_;
    int version_ = 0;
    std::vector<int> architectures_;
};

} // namespace tandem::cuda
