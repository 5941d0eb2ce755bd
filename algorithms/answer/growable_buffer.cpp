// SPDX-License-Identifier: MIT
#include "algorithms/answer/growable_buffer.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace tandem {

GrowableBuffer::GrowableBuffer(Device& device, std::vector<Column> columns, std::uint64_t rows)
    : device_(&device), columns_(std::move(columns)) {
    allocate(rows);
}

/// Allocates all columns or, on failure, none.
void GrowableBuffer::allocate(std::uint64_t rows) {
    std::vector<Buffer> buffers;
    for (const auto& column : columns_)
        buffers.push_back(device_->allocate(rows * column.row_bytes, column.label));
    buffers_ = std::move(buffers);
    capacity_ = static_cast<std::uint32_t>(rows);
}

void GrowableBuffer::grow(std::uint64_t rows) { replace(rows, rows / 8); }

void GrowableBuffer::reserve(std::uint64_t rows) {
    if (rows > capacity_) replace(rows, 0);
}

void GrowableBuffer::replace(std::uint64_t rows, std::uint64_t spare) {
    if (rows > most)
        throw OutOfMemory(fmt::format("{}: {} rows of {} exceed the limit of {} rows for one buffer",
                                      device_->info().id, rows, columns_.front().label, most));
    const auto before = capacity_;
    buffers_.clear(); // first, so that memory need not hold old and new rows at once
    capacity_ = 0;
    for (const auto wanted : {std::min(rows + spare, most), rows}) {
        try {
            allocate(wanted);
            return;
        } catch (const OutOfMemory&) {
            if (wanted > rows) continue;
            restore(before);
            throw;
        }
    }
}

/// After a failure, restores the previous capacity or a smaller one, so that the caller can free memory and
/// retry.
void GrowableBuffer::restore(std::uint64_t rows) {
    for (; rows > 0; rows /= 2) {
        try {
            allocate(rows);
            return;
        } catch (const OutOfMemory&) {} // with fewer rows
    }
}

const Buffer& GrowableBuffer::buffer(std::size_t column) const {
    if (buffers_.empty())
        throw OutOfMemory(fmt::format("{}: out of memory for {}; raise --memory, or use fewer bodies",
                                      device_->info().id, columns_[column].label));
    return buffers_[column];
}

std::size_t GrowableBuffer::row_bytes() const {
    return std::accumulate(columns_.begin(), columns_.end(), std::size_t{0},
                           [](std::size_t sum, const Column& column) { return sum + column.row_bytes; });
}

std::uint64_t available_bytes(const Device& device) {
    const auto most = std::min<std::uint64_t>(device.info().global_bytes, device.memory_limit());
    return most - std::min<std::uint64_t>(most, device.bytes_allocated());
}

std::uint64_t rows_within(const Device& device, std::size_t row_bytes, double fraction) {
    const auto bytes = static_cast<double>(available_bytes(device)) * fraction;
    const auto fitting = static_cast<std::uint64_t>(bytes / static_cast<double>(row_bytes));
    return std::clamp<std::uint64_t>(fitting, 1, GrowableBuffer::most);
}

std::uint64_t first_rows(const Device& device, std::int64_t rows, std::size_t row_bytes, double fraction) {
    const auto asked = static_cast<std::uint64_t>(rows);
    if (device.memory_limit() == Device::no_memory_limit) return asked;
    return std::min(asked, rows_within(device, row_bytes, fraction));
}

} // namespace tandem
