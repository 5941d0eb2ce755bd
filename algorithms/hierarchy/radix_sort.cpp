// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/radix_sort.h"

#include "algorithms/kernels/sources.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::uint32_t key_bits = 32;
constexpr std::uint32_t radix_bits = 8; ///< RADIX_BITS of radix_sort.cl
constexpr std::uint32_t digits = 1u << radix_bits;
static_assert(key_bits / radix_bits % 2 == 0, "the last pass must write the first buffers");

/// Each group reads the counts of all groups, so that their number is limited.
constexpr std::uint32_t most_groups = 256;
/// Rows of a group, at least; fewer cost more than they gain.
constexpr std::uint32_t least_rows = 1024;

} // namespace

RadixSort::RadixSort(Device& device, LaunchShape shape, std::uint32_t capacity)
    : device_(device), shape_(shape) {
    const auto rows = std::max<std::size_t>(capacity, 1);
    for (auto& keys : keys_) keys = device.allocate(rows * 4, "keys to sort");
    for (auto& values : values_) values = device.allocate(rows * 4, "values to sort");
    counts_ = device.allocate(grid(capacity).groups * digits * 4, "counts of digits");
    const Defines defines{{"GROUP_SIZE", std::to_string(shape.group_size)}, {"PRECISION", "32"}};
    compile_kernel(device, count_, defines);
    compile_kernel(device, scatter_, defines);
}

Grid RadixSort::grid(std::uint32_t count) const {
    return {std::clamp(count / least_rows, 1u, std::min(shape_.groups, most_groups)), shape_.group_size};
}

void RadixSort::launch(std::uint32_t count, const Buffer& flag) const {
    for (std::uint32_t pass = 0; pass < key_bits / radix_bits; ++pass) {
        const auto from = pass % 2, to = 1 - from, shift = pass * radix_bits;
        const kernels::radix_sort::CountDigits counting{
            .keys = keys_[from], .count = count, .shift = shift, .flag = flag, .counts = counts_};
        device_.launch(count_, grid(count), counting);
        const kernels::radix_sort::ScatterDigits moving{.keys = keys_[from],
                                                        .values = values_[from],
                                                        .count = count,
                                                        .shift = shift,
                                                        .flag = flag,
                                                        .counts = counts_,
                                                        .sorted_keys = keys_[to],
                                                        .sorted_values = values_[to]};
        device_.launch(scatter_, grid(count), moving);
    }
}

std::size_t RadixSort::bytes() const { return 2 * (keys_[0].bytes() + values_[0].bytes()) + counts_.bytes(); }

} // namespace tandem
