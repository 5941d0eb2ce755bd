// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <vector>

namespace tandem {

/// A byte pattern behind each buffer of a device, which shows that a kernel wrote past a buffer's end.
/// Device::guard_buffers() makes one. Its commands do not appear in the device's trace.
class BufferGuards {
public:
    /// Size of the pattern. Kernels that overrun a capacity write the first rows behind it.
    static constexpr std::size_t bytes = 1024;
    /// What an allocation holds beyond its buffer: the pattern, and memory that a longer overrun may write
    /// to, so that the process lives to report it.
    static constexpr std::size_t padding = std::size_t{1} << 18;

    /// `device` must outlive this, or be detached before it ends.
    explicit BufferGuards(Device& device) : device_(&device) {}
    void detach() { device_ = nullptr; }

    /// Writes the pattern behind a new buffer. Its memory holds `padding` more than its size.
    void add(Buffer::Impl& buffer);
    /// Checks a buffer that is about to be freed; what was found is kept for the next check().
    void remove(Buffer::Impl& buffer) noexcept;
    /// Waits for the device and checks all buffers. Throws std::logic_error that names the first buffer
    /// behind which something was written since the last call.
    void check();
    /// Tickets of the timestamps that own commands took while clocks were on, in ascending order; forgets
    /// them.
    std::vector<std::uint64_t> take_tickets() { return std::exchange(tickets_, {}); }

private:
    void check(Buffer::Impl& buffer);
    void keep(std::uint64_t ticket) {
        if (ticket != 0) tickets_.push_back(ticket);
    }

    Device* device_;
    std::vector<Buffer::Impl*> buffers_;
    std::array<std::byte, bytes> found_{};
    std::string overwritten_; ///< what the next check() throws; empty: nothing
    std::vector<std::uint64_t> tickets_;
};

} // namespace tandem
