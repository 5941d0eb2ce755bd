// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace tandem::read {

/// Reads binary data value by value. Scanner has the same functions get, check_count and fail.
class Cursor {
public:
    /// Every error begins with `location`: a file, or a location in one.
    Cursor(std::string_view bytes, std::string location, std::size_t at = 0,
           std::endian order = std::endian::little)
        : bytes_(bytes), location_(std::move(location)), order_(order), at_(at), value_(at) {}

    /// Reads the next T. Fails at the end of the data and when T is not finite.
    template<class T>
    T get(std::string_view what);
    /// Fails unless the rest of the data can contain n items of `bytes` bytes each.
    void check_count(std::uint64_t n, std::size_t values, std::size_t bytes, std::string_view what) const;
    /// Throws InputError with the position of the last value.
    [[noreturn]] void fail(std::string_view what, std::string_view remedy) const;

    std::size_t at() const { return at_; }
    bool done() const { return at_ == bytes_.size(); }

private:
    [[noreturn]] void fail_end(std::string_view what) const;
    [[noreturn]] void fail_finite(std::string_view what) const;

    std::string_view bytes_;
    std::string location_;
    std::endian order_;
    std::size_t at_;
    std::size_t value_; ///< position of the last value
};

template<class T>
T Cursor::get(std::string_view what) {
    value_ = at_;
    if (bytes_.size() - at_ < sizeof(T)) fail_end(what);
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if (order_ != std::endian::native) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    const T value = std::bit_cast<T>(raw);
    if constexpr (std::is_floating_point_v<T>)
        if (!std::isfinite(value)) fail_finite(what);
    return value;
}

} // namespace tandem::read
