// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/driver.h"
#include "backends/device.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace tandem::cuda {

/// A driver command, to be enqueued now or later. It stores addresses; their memory must stay valid until the
/// command has run.
struct Command {
    enum class Kind { launch, upload, download, clear };

    /// More than any kernel has. A fixed size needs no memory from the heap.
    static constexpr std::size_t max_arguments = 32;

    Kind kind = Kind::launch;
    Function function = nullptr;                       ///< for launches, like the next two
    unsigned groups = 0;                               ///< work-groups
    unsigned group_size = 0;                           ///< work-items
    std::size_t arguments = 0;                         ///< number of `values`
    DevicePointer device = 0;                          ///< for transfers and clears, like the next two
    void* host = nullptr;                              ///< page-locked if the transfer does not block
    std::size_t bytes = 0;                             ///< to copy or clear
    std::string_view label;                            ///< kernel entry or buffer, for errors
    std::array<std::uint64_t, max_arguments> values{}; ///< addresses, or scalars from the first byte on

    /// Enqueues the command; returns the driver's code.
    Result submit(const Driver& driver, Stream stream) const;
    /// The driver function that submit() calls.
    std::string_view call() const;
    /// "launching 'x' with 4 groups of 128"
    std::string describe() const;
    /// Whether both do the same; labels do not count.
    bool operator==(const Command& other) const;
};

} // namespace tandem::cuda
