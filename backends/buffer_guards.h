// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <vector>

namespace tandem {

/// Writes a byte pattern behind each buffer of a device to detect kernels that write past a buffer's end, and
/// on request fills buffers to detect those that read what nothing has written. Device::guard_buffers()
/// creates it. Its commands do not appear in the device's trace.
class BufferGuards {
public:
    /// Size of the pattern. Kernels that overrun a capacity write the first rows behind it.
    static constexpr std::size_t bytes = 1024;
    /// Bytes of an allocation beyond its buffer: the pattern, and spare memory for a longer overrun, so that
    /// the process survives to report it.
    static constexpr std::size_t padding = std::size_t{1} << 18;

    /// `device` must outlive this object, or call detach() before it ends.
    explicit BufferGuards(Device& device) : device_(&device) {}
    void detach() { device_ = nullptr; }

    /// Writes the pattern behind a new buffer, whose allocation is `padding` bytes larger than the buffer.
    void add(Buffer::Impl& buffer);
    /// Fills all buffers but those of uploaded() and those labelled with one of `kept`, and later every new
    /// buffer, with `word`.
    void fill(std::uint32_t word, std::span<const std::string_view> kept);
    /// Checks a buffer before it is freed; the next check() reports the result.
    void remove(Buffer::Impl& buffer) noexcept;
    /// Waits for the device and checks all buffers. Throws std::logic_error that names the first buffer with
    /// an overrun since the last call.
    void check();
    /// Returns and forgets the tickets of this object's own commands while clocks were on, ascending.
    std::vector<std::uint64_t> take_tickets() { return std::exchange(tickets_, {}); }

private:
    void check(Buffer::Impl& buffer);
    void fill(Buffer::Impl& buffer);
    void add_ticket(std::uint64_t ticket) {
        if (ticket != 0) tickets_.push_back(ticket);
    }

    Device* device_;
    std::vector<Buffer::Impl*> buffers_;
    std::vector<std::uint32_t> filling_; ///< copies of the word that new buffers get; empty: none
    std::array<std::byte, bytes> read_back_{};
    std::string overwritten_; ///< message that the next check() throws; empty: none
    std::vector<std::uint64_t> tickets_;
};

} // namespace tandem
