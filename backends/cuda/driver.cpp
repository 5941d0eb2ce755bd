// SPDX-License-Identifier: MIT
#include "backends/cuda/driver.h"

#include "backends/device.h"

#include <array>
#include <fmt/format.h>

namespace tandem::cuda {

namespace {

Library open_driver() {
    const std::array<std::string, 1> names{"libcuda.so.1"};
    try {
        return Library(names);
    } catch (const DeviceError& error) {
        throw DeviceError(fmt::format("cuda: no driver ({}); install NVIDIA's", error.what()));
    }
}

} // namespace

std::string version_text(int version) { return fmt::format("{}.{}", version / 1000, version % 1000 / 10); }

Driver::Driver() : library(open_driver()) {
    const auto load = [&](auto*& entry, const char* name) {
        entry = reinterpret_cast<std::remove_reference_t<decltype(entry)>>(library.find(name));
        if (entry == nullptr)
            throw DeviceError(
                fmt::format("cuda: the driver {} has no {}; it is older than CUDA 11.4: install a newer one",
                            library.name(), name));
    };
#define TANDEM_LOAD(name, arguments) load(name, #name);
    TANDEM_CUDA_ENTRIES(TANDEM_LOAD)
#undef TANDEM_LOAD
// NOLINTNEXTLINE(bugprone-macro-parentheses): a name
#define TANDEM_FIND(name, arguments) name = reinterpret_cast<decltype(name)>(library.find(#name));
    TANDEM_CUDA_OPTIONAL_ENTRIES(TANDEM_FIND)
#undef TANDEM_FIND
    if (const auto code = cuInit(0); code != 0)
        throw DeviceError(
            fmt::format("cuda: the driver is installed, but cuInit failed with {}", describe(code)));
    cuDriverGetVersion(&version);
}

std::string Driver::describe(Result result) const {
    const char* name = nullptr;
    const char* text = nullptr;
    cuGetErrorName(result, &name);
    cuGetErrorString(result, &text);
    return fmt::format("{} ({})", name != nullptr ? name : fmt::format("code {}", result),
                       text != nullptr ? text : "unknown to this driver");
}

} // namespace tandem::cuda
