// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace tandem::exporting {

/// Builds the two chunks of a binary glTF 2.0 file (Khronos 2017, section 4.4).
class GlbFile {
public:
    GlbFile();

    /// Each adds an accessor with its own view and returns its index. An item has `components` numbers
    /// (1: SCALAR, 3: VEC3, 4: VEC4). The accessor of floats has the minimum and maximum of each component.
    std::size_t floats(std::span<const float> values, std::size_t components, bool vertices = false);
    std::size_t indices(std::span<const std::uint32_t> values);

    /// Appends an object to a top-level array ("nodes") and returns its index.
    std::size_t add(const char* array, nlohmann::json object);
    nlohmann::json& json() { return json_; }

    std::string finish();

private:
    std::size_t view(std::size_t offset, int target);

    nlohmann::json json_;
    std::string binary_;
};

} // namespace tandem::exporting
