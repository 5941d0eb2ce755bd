// SPDX-License-Identifier: MIT
// A device of the CUDA adaptor on the stub of the driver.
#pragma once

#include "backends/cuda/cuda_device.h"
#include "tests/cuda/stub_driver.h"
#include "tests/support/test.h"

#include <dlfcn.h>

namespace tandem {

using Context = CUctx_st*;

template<class Function>
Function* entry_of_stub(const char* name) {
    static auto* const library = dlopen("libcuda.so.1", RTLD_NOW);
    return reinterpret_cast<Function*>(dlsym(library, name));
}

/// An entry point of the driver, as an application looks it up.
template<class... Arguments>
auto entry(const char* name) {
    return entry_of_stub<int(Arguments...)>(name);
}

inline Context current() {
    Context context = nullptr;
    entry<Context*>("cuCtxGetCurrent")(&context);
    return context;
}

inline void make_current(Context context) { entry<Context>("cuCtxSetCurrent")(context); }

class CudaDevice : public testing::Test {
protected:
    CudaDevice() {
        auto found = cuda::discover();
        if (!found.devices.empty()) device = std::move(found.devices.front());
        entry<Context*, unsigned, int>("cuCtxCreate_v2")(&other, 0, 0);
        make_current(nullptr);
    }
    void SetUp() override {
        ASSERT_NE(device, nullptr) << "LD_LIBRARY_PATH and TANDEM_NVRTC name the stubs";
        ASSERT_EQ(device->info().name, "Stub GPU");
    }
    ~CudaDevice() override {
        device.reset();
        entry<Context>("cuCtxDestroy_v2")(other);
    }

    std::unique_ptr<Device> device;
    Context other = nullptr; ///< the application's
};

} // namespace tandem
