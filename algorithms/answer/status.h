// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/kernels/status.clh"
#include "backends/device.h"

#include <array>

namespace tandem {

static_assert(STATUS_OWN % 2 == 0, "some add to a counter as to one word of 64 bits");

/// The words of status.clh on one device, and the host's copy of them.
class Status {
public:
    /// Uploads of words: queued for the resident data path, blocking for the published one, as in the paper's
    /// code.
    enum class Writes { queued, blocking };

    /// `device` must outlive it. Throws OutOfMemory.
    Status(Device& device, Writes writes);

    /// Clears all words and sets the number of body pairs: the number that the host has found, or 0.
    void begin(std::uint64_t body_pairs);
    /// Writes the host's copy with the 64-bit counter at `word` set to `value`.
    void set(std::size_t word, std::uint64_t value);
    /// Writes the host's copy with the window of a windowed walk, items first..end - 1.
    void set_window(std::uint32_t first, std::uint32_t end);
    /// Waits for the device and reads all words. Throws DeviceError that names the bound if a kernel has
    /// found one not to hold (STATUS_EXCEEDED).
    void read();
    /// The 64-bit counter whose low word is number `word`, as last read or written.
    std::uint64_t counter(std::size_t word) const { return counter_in(words_, word); }

    /// All words, as last read or written.
    using Words = std::array<std::uint32_t, STATUS_WORDS>;
    /// The 64-bit counter of `words` whose low word is number `word`.
    static std::uint64_t counter_in(const Words& words, std::size_t word) {
        return words[word] | std::uint64_t{words[word + 1]} << 32;
    }
    const Words& words() const { return words_; }
    void write(const Words& words);

    /// STATUS_WORDS words.
    const Buffer& buffer() const { return buffer_; }

private:
    void put(std::size_t word, std::uint64_t value);

    Device& device_;
    Writes writes_;
    Words words_{};
    Buffer buffer_;
};

} // namespace tandem
