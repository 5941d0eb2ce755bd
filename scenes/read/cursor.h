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

/// Walks over binary data, little endian unless told otherwise. Shares get, room and fail with Scanner.
class Cursor {
public:
    /// `where` opens every error: a file, or a place in one.
    Cursor(std::string_view bytes, std::string where, std::size_t at = 0,
           std::endian order = std::endian::little)
        : bytes_(bytes), where_(std::move(where)), order_(order), at_(at), value_(at) {}

    /// The next T; fails at the end of the data and on a T that is not finite.
    template<class T>
    T get(std::string_view what);
    /// Fails unless n items of `bytes` bytes each can still follow.
    void room(std::uint64_t n, std::size_t values, std::size_t bytes, std::string_view what) const;
    /// Throws InputError that points at the last value.
    [[noreturn]] void fail(std::string_view what, std::string_view remedy) const;

    std::size_t at() const { return at_; }
    bool done() const { return at_ == bytes_.size(); }

private:
    [[noreturn]] void fail_end(std::string_view what) const;
    [[noreturn]] void fail_finite(std::string_view what) const;

    std::string_view bytes_;
    std::string where_;
    std::endian order_;
    std::size_t at_;
    std::size_t value_; ///< where the last value starts
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
