// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tandem::exporting {

/// Colours from 0 to the largest value as sRGB, 0xRRGGBB, at equal distances. Lightness rises steadily, so
/// that readers with colour blindness can order them (viridis, van der Walt and Smith 2015).
inline constexpr std::array<std::uint32_t, 5> scale_colours{0x440154, 0x3b528b, 0x21918c, 0x5ec962, 0xfde725};

/// The colour of a part of the largest value, interpolated in sRGB, as linear RGB (IEC 61966-2-1).
inline std::array<float, 3> linear_colour(double part) {
    constexpr auto last = scale_colours.size() - 1;
    const double place = std::clamp(part, 0.0, 1.0) * static_cast<double>(last);
    const auto from = std::min(static_cast<std::size_t>(place), last - 1);
    std::array<float, 3> colour{};
    for (unsigned i = 0; i < 3; ++i) {
        const auto channel = [&](std::size_t at) {
            return (scale_colours[at] >> (16 - 8 * i) & 0xff) / 255.0;
        };
        const double value =
            channel(from) + (place - static_cast<double>(from)) * (channel(from + 1) - channel(from));
        colour[i] =
            static_cast<float>(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
    }
    return colour;
}

} // namespace tandem::exporting
