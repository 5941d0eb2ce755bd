// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <limits>

namespace tandem {

/// A device buffer for rows of which it is known only afterwards how many there are. Kernels number rows by
/// words, so that it never holds more than 2^32 - 1.
class Room {
public:
    static constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();

    Room() = default;
    /// Room for `rows` of `row_bytes` bytes each. Throws OutOfMemory.
    Room(Device& device, std::string_view label, std::size_t row_bytes, std::uint64_t rows);

    /// Makes room for `rows`, and for an eighth more where memory allows; what was there is lost. Throws
    /// OutOfMemory, after which there is as much room as before, or none when even that is not to be had.
    void grow(std::uint64_t rows);
    /// Makes room for `rows` at least, and no more than that where there is less. Otherwise as grow().
    void widen(std::uint64_t rows);
    std::uint64_t rows() const { return rows_; }
    /// The same as kernels take it.
    std::uint32_t capacity() const { return static_cast<std::uint32_t>(rows_); }
    /// Throws OutOfMemory when there is none.
    const Buffer& buffer() const;
    /// Bytes of a row.
    std::size_t row_bytes() const { return row_bytes_; }

private:
    void allocate(std::uint64_t rows);
    void replace(std::uint64_t rows, std::uint64_t spare);
    void restore(std::uint64_t rows);

    Device* device_ = nullptr;
    std::string_view label_;
    std::size_t row_bytes_ = 0;
    std::uint64_t rows_ = 0;
    Buffer buffer_;
};

/// What a device can still give, as far as its size, its limit and what it has given tell.
std::uint64_t available_bytes(const Device& device);

/// As many rows of `row_bytes` bytes as fit into that share of what is available; 1 at least, Room::most at
/// most.
std::uint64_t rows_within(const Device& device, std::size_t row_bytes, double share);

/// The room to begin with where `rows` are asked for: all of them, or as many as fit into that share where
/// the device's memory has been limited by hand.
std::uint64_t first_rows(const Device& device, std::int64_t rows, std::size_t row_bytes, double share);

} // namespace tandem
