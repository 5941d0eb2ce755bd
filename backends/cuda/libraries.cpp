// SPDX-License-Identifier: MIT
#include "backends/cuda/libraries.h"

#include "backends/cuda/nvml.h"
#include "backends/device.h"

#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <vector>

namespace tandem::cuda {

namespace {

std::string names_of_devices(const Driver& driver) {
    int count = 0;
    driver.cuDeviceGetCount(&count);
    std::vector<std::string> names;
    for (int i = 0; i < count; ++i) {
        std::array<char, 256> text{};
        driver.cuDeviceGetName(text.data(), static_cast<int>(text.size()), i);
        names.emplace_back(text.data());
    }
    return fmt::format("{} device(s): {}", count, fmt::join(names, ", "));
}

Nvrtc open_nvrtc(const Driver& driver) {
    try {
        return Nvrtc(driver.version);
    } catch (const DeviceError& error) {
        throw DeviceError(fmt::format("cuda: {}, but {}", names_of_devices(driver), error.what()));
    }
}

} // namespace

Libraries::Libraries() : nvrtc(open_nvrtc(driver)) {}

std::shared_ptr<Libraries> libraries() {
    static const auto loaded = std::make_shared<Libraries>();
    return loaded;
}

std::string kernel_driver() {
    std::ifstream file("/sys/module/nvidia/version");
    std::string version;
    file >> version;
    if (version.empty()) version = nvml()->driver().value_or("");
    return version.empty() ? "" : ", " + version;
}

} // namespace tandem::cuda
