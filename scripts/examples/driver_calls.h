// SPDX-License-Identifier: MIT
// Calls of the CUDA driver without a toolkit: its entry points are loaded by name.
#pragma once

#include <cstdio>
#include <dlfcn.h>

using Handle = void*; ///< CUcontext, CUstream, CUgraph, CUgraphExec
using Pointer = unsigned long long;

inline void* library() {
    static auto* const opened = dlopen("libcuda.so.1", RTLD_NOW);
    return opened;
}

template<class Function>
Function* entry(const char* name) {
    return reinterpret_cast<Function*>(dlsym(library(), name));
}

/// Calls an entry point; prints its name and code, and returns false, if it fails.
template<class... Arguments>
bool call(const char* name, Arguments... arguments) {
    auto* const function = entry<int(Arguments...)>(name);
    const int code = function != nullptr ? function(arguments...) : -1;
    if (code != 0) std::fprintf(stderr, "%s failed with %d\n", name, code);
    return code == 0;
}

/// Prints what is wrong unless `good`, which it returns.
inline bool check(bool good, const char* what) {
    if (!good) std::fprintf(stderr, "%s\n", what);
    return good;
}

/// Whether the driver is the stub of tandem's tests, which runs no kernels.
inline bool is_stub() { return entry<void()>("stub_all_calls") != nullptr; }

/// Makes a context that is not current. The driver makes a new context current, so that it is popped.
inline bool create(Handle& context) {
    Handle popped = nullptr;
    return call("cuCtxCreate_v2", &context, 0u, 0) && call("cuCtxPopCurrent_v2", &popped);
}

/// Makes a stream of a context.
inline bool create_stream(Handle context, Handle& stream) {
    return call("cuCtxSetCurrent", context) && call("cuStreamCreate", &stream, 1u)
           && call("cuCtxSetCurrent", Handle{});
}
