// SPDX-License-Identifier: MIT
#include "backends/library.h"

#include "backends/device.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem {

Library::Library(std::span<const std::string> names) {
    for (const auto& name : names) {
        handle_ = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
        name_ = name;
        if (handle_ != nullptr) return;
    }
    throw DeviceError(fmt::format("looked for {}", fmt::join(names, ", ")));
}

std::optional<Library> library_if_any(std::span<const std::string> names) {
    try {
        return Library(names);
    } catch (const DeviceError&) {
        return std::nullopt;
    }
}

void* Library::find(const char* symbol) const { return dlsym(handle_, symbol); }

} // namespace tandem
