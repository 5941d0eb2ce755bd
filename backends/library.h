// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>

namespace tandem {

/// A shared library loaded at run time. It stays loaded, because drivers do not support being unloaded.
class Library {
public:
    /// Opens the first of `names` that loads. Throws DeviceError: "looked for A, B".
    explicit Library(std::span<const std::string> names);

    const std::string& name() const { return name_; }
    /// The address of `symbol`; null when the library has none.
    void* find(const char* symbol) const;

private:
    std::string name_;
    void* handle_ = nullptr;
};

/// The first of `names` that loads; no value when none does.
std::optional<Library> library_if_any(std::span<const std::string> names);

} // namespace tandem
