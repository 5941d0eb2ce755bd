// SPDX-License-Identifier: MIT
// Loaded before a program, between it and the CUDA driver and NVRTC (stubs or real ones). Every entry point
// that the program looks up by name is one of this file, which counts calls and makes one fail.
//   SHIM_CALL    number of the failing call, from 1; 0: none
//   SHIM_CODE    its error code; 2 by default: CUDA_ERROR_OUT_OF_MEMORY
//   SHIM_STAYS   if set, all later calls fail too, as on a lost device
//   SHIM_COUNT   a file for the number of calls
//   SHIM_FAILED  a file for the name of the first failing call
#include "backends/cuda/driver.h"
#include "backends/cuda/nvrtc.h"

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <string>

namespace {

using namespace tandem::cuda;

long number(const char* name, long otherwise) {
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : std::atol(text);
}

std::atomic<long> calls{0};

void print_message(const char* file, const char* text) {
    const char* path = std::getenv(file);
    std::FILE* out = path == nullptr ? nullptr : std::fopen(path, "w");
    if (out == nullptr) return;
    std::fprintf(out, "%s\n", text);
    std::fclose(out);
}

/// Whether this call fails.
bool fails(const char* name) {
    static const long at = number("SHIM_CALL", 0);
    static const bool stays = std::getenv("SHIM_STAYS") != nullptr;
    const long call = ++calls;
    if (at != 0 && call == at) print_message("SHIM_FAILED", name);
    return at != 0 && (stays ? call >= at : call == at);
}

struct Tell {
    ~Tell() { print_message("SHIM_COUNT", std::to_string(calls.load()).c_str()); }
} tell_at_the_end;

enum Entry : std::size_t {
#define TANDEM_NUMBER(name, arguments) entry_##name,
    TANDEM_CUDA_ENTRIES(TANDEM_NUMBER) TANDEM_CUDA_OPTIONAL_ENTRIES(TANDEM_NUMBER)
        TANDEM_NVRTC_ENTRIES(TANDEM_NUMBER) entries
#undef TANDEM_NUMBER
};
std::array<void*, entries> behind{};

constexpr const char* names[] = {
#define TANDEM_NAME(name, arguments) #name,
    TANDEM_CUDA_ENTRIES(TANDEM_NAME) TANDEM_CUDA_OPTIONAL_ENTRIES(TANDEM_NAME)
        TANDEM_NVRTC_ENTRIES(TANDEM_NAME)
#undef TANDEM_NAME
};

template<class Signature>
struct Counted;
template<class... Arguments>
struct Counted<int(Arguments...)> {
    template<std::size_t entry>
    static int call(Arguments... arguments) {
        if (fails(names[entry])) return static_cast<int>(number("SHIM_CODE", 2));
        return reinterpret_cast<int (*)(Arguments...)>(behind[entry])(arguments...);
    }
};

template<class Function>
void* address(Function* function) {
    return reinterpret_cast<void*>(function);
}

void* const counted[] = {
#define TANDEM_COUNTED(name, arguments) address(&Counted<int arguments>::call<entry_##name>),
    TANDEM_CUDA_ENTRIES(TANDEM_COUNTED) TANDEM_CUDA_OPTIONAL_ENTRIES(TANDEM_COUNTED)
        TANDEM_NVRTC_ENTRIES(TANDEM_COUNTED)
#undef TANDEM_COUNTED
};

} // namespace

extern "C" void* dlsym(void* handle, const char* name) noexcept {
    using Find = void*(void*, const char*);
    static auto* const real = reinterpret_cast<Find*>(dlvsym(RTLD_NEXT, "dlsym", "GLIBC_2.2.5"));
    void* const found = real(handle, name);
    for (std::size_t entry = 0; found != nullptr && entry < entries; ++entry) {
        if (std::strcmp(names[entry], name) != 0) continue;
        behind[entry] = found;
        return counted[entry];
    }
    return found;
}
