// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <limits>
#include <vector>

namespace tandem {

/// One of the arrays that rows lie in.
struct Column {
    std::string_view label; ///< names its buffer in traces and errors; a literal
    std::size_t row_bytes = 0;
};

/// Device memory for rows of which it is known only afterwards how many there are. A row may lie in several
/// columns, a buffer each. All columns always hold the same number of rows, so that one capacity is true of
/// every buffer that a kernel is given with it. Kernels number rows by words: capacity() is at most
/// 2^32 - 1.
class GrowableBuffer {
public:
    static constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();

    GrowableBuffer() = default;
    /// Holds `rows` rows. Throws OutOfMemory.
    GrowableBuffer(Device& device, std::vector<Column> columns, std::uint64_t rows);
    GrowableBuffer(Device& device, std::string_view label, std::size_t row_bytes, std::uint64_t rows)
        : GrowableBuffer(device, std::vector{Column{label, row_bytes}}, rows) {}

    /// Replaces all columns by ones for `rows`, and for an eighth more where memory allows; their contents
    /// are lost. Throws OutOfMemory, after which the capacity is as before, or as near to that as memory
    /// allows.
    void grow(std::uint64_t rows);
    /// Does nothing where there are so many rows; otherwise as grow(), without the eighth.
    void reserve(std::uint64_t rows);

    /// Rows that each column holds.
    std::uint32_t capacity() const { return capacity_; }
    /// A column. Throws OutOfMemory where there was no memory for a single row.
    const Buffer& buffer(std::size_t column = 0) const;
    std::size_t row_bytes(std::size_t column) const { return columns_[column].row_bytes; }
    /// Bytes of one row, in all columns.
    std::size_t row_bytes() const;

private:
    void allocate(std::uint64_t rows);
    void replace(std::uint64_t rows, std::uint64_t spare);
    void restore(std::uint64_t rows);

    Device* device_ = nullptr;
    std::vector<Column> columns_;
    std::uint32_t capacity_ = 0;
    std::vector<Buffer> buffers_; ///< one for each column, or none
};

/// What a device can still give, as far as its size, its limit and what it has given tell.
std::uint64_t available_bytes(const Device& device);

/// As many rows of `row_bytes` bytes as fit into that fraction of what is available; at least 1, at most
/// GrowableBuffer::most.
std::uint64_t rows_within(const Device& device, std::size_t row_bytes, double fraction);

/// The capacity to begin with where `rows` are asked for: all of them, or as many as fit into that fraction
/// of what is available where the device's memory has been limited by hand.
std::uint64_t first_rows(const Device& device, std::int64_t rows, std::size_t row_bytes, double fraction);

} // namespace tandem
