// SPDX-License-Identifier: MIT
#include "backends/cuda/cupti.h"

#include "backends/device.h"

#include <cstdlib>
#include <fmt/format.h>
#include <optional>
#include <utility>

namespace tandem::cuda {

namespace {

/// The version of CUDA 12.6. With earlier versions, graphs launched after CUPTI was detached fail
/// (pytorch/kineto, pull request 1264), and tandem's frames are graphs.
constexpr std::uint32_t first_usable = 24;

/// Versions from 13.0 on have the form 130001 (second release of 13.0); earlier ones are consecutive numbers.
std::string cupti_version_text(std::uint32_t version) {
    return version < 100000 ? fmt::format("API {}", version)
                            : fmt::format("{}.{}", version / 10000, version % 10000 / 100);
}

} // namespace

std::unique_ptr<const Cupti> open_cupti(std::span<const std::string> names) {
    const auto library = library_if_any(names); // which stays loaded
    if (!library) return nullptr;
    auto cupti = std::make_unique<Cupti>();
    const auto load = [&](auto*& entry, const char* name) {
        entry = reinterpret_cast<std::remove_reference_t<decltype(entry)>>(library->find(name));
        if (entry == nullptr) throw DeviceError(fmt::format("it has no {}", name));
    };
#define TANDEM_LOAD(name, arguments) load(cupti->name, #name);
    TANDEM_CUPTI_ENTRIES(TANDEM_LOAD)
#undef TANDEM_LOAD
    std::uint32_t version = 0;
    cupti->cuptiGetVersion(&version);
    cupti->version = cupti_version_text(version);
    if (version < first_usable) throw DeviceError(fmt::format("{} is older than CUDA 12.6", cupti->version));
    return cupti;
}

std::vector<std::string> cupti_candidates(int driver_version) {
    if (const auto* chosen = std::getenv("TANDEM_CUPTI")) {
        if (*chosen == '\0') return {};
        return {chosen};
    }
    std::vector<std::string> names;
    for (const int major : {13, 12}) {
        if (major > driver_version / 1000) continue;
        const auto name = fmt::format("libcupti.so.{}", major);
        names.push_back(name);
        // The loader may not search a toolkit's own folders.
        names.push_back("/usr/local/cuda/lib64/" + name);
        names.push_back("/usr/local/cuda/extras/CUPTI/lib64/" + name);
    }
    return names;
}

} // namespace tandem::cuda
