// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <limits>
#include <vector>

namespace tandem {

/// One column of rows, in a buffer of its own.
struct Column {
    std::string_view label; ///< names its buffer in traces and errors; a literal
    std::size_t row_bytes = 0;
};

/// Device memory for rows whose number is known only after a kernel has written them. Rows may have several
/// columns, each in its own buffer. All columns have the same capacity, which kernels get with each of them.
/// Kernels number rows with 32 bits: capacity() is at most 2^32 - 1.
class GrowableBuffer {
public:
    static constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();

    GrowableBuffer() = default;
    /// Allocates `rows` rows. Throws OutOfMemory.
    GrowableBuffer(Device& device, std::vector<Column> columns, std::uint64_t rows);
    GrowableBuffer(Device& device, std::string_view label, std::size_t row_bytes, std::uint64_t rows)
        : GrowableBuffer(device, std::vector{Column{label, row_bytes}}, rows) {}

    /// Replaces all columns by ones for `rows`, and for an eighth more where memory allows; their contents
    /// are lost. Throws OutOfMemory; the capacity is then the previous one, or less if memory is short.
    void grow(std::uint64_t rows);
    /// Grows to `rows` exactly if the capacity is smaller; contents are lost then. Throws as grow().
    void reserve(std::uint64_t rows);

    /// Capacity of each column, in rows.
    std::uint32_t capacity() const { return capacity_; }
    /// A column. Throws OutOfMemory if an earlier growth failed and left no rows.
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
    std::vector<Buffer> buffers_; ///< by column; empty after a failure
};

/// Bytes that a device can still allocate, from its memory size, its limit and its allocations.
std::uint64_t available_bytes(const Device& device);

/// The number of rows that fit into `fraction` of the available memory; at least 1, at most
/// GrowableBuffer::most.
std::uint64_t rows_within(const Device& device, std::size_t row_bytes, double fraction);

/// The initial capacity for `rows`. If the device has a memory limit, at most the rows that fit into
/// `fraction` of the available memory.
std::uint64_t first_rows(const Device& device, std::int64_t rows, std::size_t row_bytes, double fraction);

} // namespace tandem
