// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/driver.h"
#include "backends/device.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace tandem::cuda {

/// A command as the driver takes it, to be enqueued now or later. It holds addresses: what is at them has to
/// live until it has run.
struct Command {
    enum class Kind { launch, upload, download, clear };

    /// More than any kernel has, so that a command needs no memory from the heap.
    static constexpr std::size_t most_arguments = 32;

    Kind kind = Kind::launch;
    Function function = nullptr;                        ///< of a launch, as the next two
    unsigned groups = 0;                                ///< work-groups
    unsigned group_size = 0;                            ///< work-items
    std::size_t arguments = 0;                          ///< of `values`
    DevicePointer device = 0;                           ///< of a transfer or a clear, as the next two
    void* host = nullptr;                               ///< page-locked where it does not block
    std::size_t bytes = 0;                              ///< to be moved or cleared
    std::string_view label;                             ///< kernel entry or buffer, for errors
    std::array<std::uint64_t, most_arguments> values{}; ///< addresses, and scalars from their first byte on

    /// Enqueues it; the driver's code.
    Result submit(const Driver& driver, Stream stream) const;
    /// The driver's function that does.
    std::string_view call() const;
    /// "launching 'x' with 4 groups of 128"
    std::string describe() const;
    /// Whether they do the same, whatever the labels.
    bool operator==(const Command& other) const;
};

} // namespace tandem::cuda
