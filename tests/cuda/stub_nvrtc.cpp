// SPDX-License-Identifier: MIT
// An NVRTC that compiles everything to a few bytes. STUB_NVRTC is its major version; with STUB_BROKEN it
// fails. With STUB_COMPILERS a compilation waits until so many have begun, and fails after a minute.
#include "backends/cuda/nvrtc.h"

#include <atomic>
#include <chrono>
#include <cstdlib>

using namespace tandem::cuda;

namespace {
std::atomic<int> compiling = 0; ///< calls of nvrtcCompileProgram since STUB_COMPILERS was set
} // namespace

extern "C" {
NvrtcResult nvrtcVersion(int* major, int* minor) {
    const auto* text = std::getenv("STUB_NVRTC");
    *major = text != nullptr ? std::atoi(text) : 13;
    *minor = 0;
    return 0;
}
NvrtcResult nvrtcGetNumSupportedArchs(int* count) {
    *count = 2;
    return 0;
}
NvrtcResult nvrtcGetSupportedArchs(int* values) {
    values[0] = 75;
    values[1] = 90;
    return 0;
}
NvrtcResult nvrtcCreateProgram(Program* program, const char*, const char*, int, const char* const*,
                               const char* const*) {
    *program = nullptr;
    return 0;
}
NvrtcResult nvrtcDestroyProgram(Program*) { return 0; }
NvrtcResult nvrtcCompileProgram(Program, int, const char* const*) {
    if (const auto* text = std::getenv("STUB_COMPILERS")) {
        ++compiling;
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
        while (compiling < std::atoi(text))
            if (std::chrono::steady_clock::now() > end) return 6;
    }
    return std::getenv("STUB_BROKEN") != nullptr ? 6 : 0;
}
NvrtcResult nvrtcGetProgramLogSize(Program, std::size_t* size) {
    *size = 8;
    return 0;
}
NvrtcResult nvrtcGetProgramLog(Program, char* log) {
    std::memcpy(log, "nothing", 8);
    return 0;
}
NvrtcResult nvrtcGetPTXSize(Program, std::size_t* size) { return *size = 4, 0; }
NvrtcResult nvrtcGetPTX(Program, char* text) { return std::memcpy(text, "ptx", 4), 0; }
NvrtcResult nvrtcGetCUBINSize(Program, std::size_t* size) { return *size = 4, 0; }
NvrtcResult nvrtcGetCUBIN(Program, char* text) { return std::memcpy(text, "bin", 4), 0; }
}
