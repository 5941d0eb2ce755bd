// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/radix_sort.cl.h"
#include "algorithms/kernels/launch_shape.h"
#include "backends/device.h"

namespace tandem {

/// Sorts 32-bit keys with 32-bit values on a device, stable and ascending, in a fixed sequence of launches.
class RadixSort {
public:
    /// For at most `capacity` rows, fewer than 2^31. Throws OutOfMemory or DeviceError.
    RadixSort(Device& device, LaunchShape shape, std::uint32_t capacity);

    /// Enqueues the sort of the first `count` rows by all bits of their keys. If the first word of `flag` is
    /// 0 on the device, the launches end at once and the rows are undefined.
    void launch(std::uint32_t count, const Buffer& flag) const;

    const Buffer& keys() const { return keys_[0]; }     ///< input and output
    const Buffer& values() const { return values_[0]; } ///< input and output
    std::size_t bytes() const;

private:
    Grid grid(std::uint32_t count) const;

    Device& device_;
    LaunchShape shape_;
    std::array<Buffer, 2> keys_, values_; ///< rows before and after every other pass
    Buffer counts_;
    KernelOf<kernels::radix_sort::CountDigits> count_;
    KernelOf<kernels::radix_sort::ScatterDigits> scatter_;
};

} // namespace tandem
