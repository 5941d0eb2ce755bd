// SPDX-License-Identifier: MIT
#include "algorithms/answer/room.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace tandem {

Room::Room(Device& device, std::string_view label, std::size_t row_bytes, std::uint64_t rows)
    : device_(&device), label_(label), row_bytes_(row_bytes) {
    allocate(rows);
}

void Room::allocate(std::uint64_t rows) {
    buffer_ = device_->allocate(rows * row_bytes_, label_);
    rows_ = rows;
}

void Room::grow(std::uint64_t rows) { replace(rows, rows / 8); }

void Room::widen(std::uint64_t rows) {
    if (rows > rows_) replace(rows, 0);
}

/// Room for so many rows, and for `spare` more where memory allows.
void Room::replace(std::uint64_t rows, std::uint64_t spare) {
    if (rows > most)
        throw OutOfMemory(fmt::format("{}: {} rows of {} do not fit into one buffer of at most {}",
                                      device_->info().id, rows, label_, most));
    const auto before = rows_;
    buffer_ = {}; // first, so that old and new need not fit side by side
    rows_ = 0;
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

/// After a failure: as much as there was, if it is to be had.
void Room::restore(std::uint64_t rows) {
    try {
        allocate(rows);
    } catch (const OutOfMemory&) {
        rows_ = 0;
    }
}

const Buffer& Room::buffer() const {
    if (!buffer_)
        throw OutOfMemory(fmt::format("{}: there was no memory for {}", device_->info().id, label_));
    return buffer_;
}

std::uint64_t available_bytes(const Device& device) {
    const auto most = std::min<std::uint64_t>(device.info().global_bytes, device.memory_limit());
    return most - std::min<std::uint64_t>(most, device.bytes_allocated());
}

std::uint64_t rows_within(const Device& device, std::size_t row_bytes, double share) {
    const auto bytes = static_cast<double>(available_bytes(device)) * share;
    const auto fitting = static_cast<std::uint64_t>(bytes / static_cast<double>(row_bytes));
    return std::clamp<std::uint64_t>(fitting, 1, Room::most);
}

std::uint64_t first_rows(const Device& device, std::int64_t rows, std::size_t row_bytes, double share) {
    const auto asked = static_cast<std::uint64_t>(rows);
    if (device.memory_limit() == Device::no_memory_limit) return asked;
    return std::min(asked, rows_within(device, row_bytes, share));
}

} // namespace tandem
