// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/status.clh"
#include "backends/device.h"

#include <array>

namespace tandem {

/// The words of status.clh on one device, and what the host knows of them.
class Status {
public:
    /// How words travel: resident ones wait for nothing, published ones as the paper's code did.
    enum class Writes { queued, blocking };

    /// `device` must outlive it. Throws OutOfMemory.
    Status(Device& device, Writes writes);

    /// Clears all words but the number of body pairs: those the host has found, or 0.
    void begin(std::uint64_t body_pairs);
    /// Sets the 64-bit counter at `word`; all others are as they were last read or written.
    void set(std::size_t word, std::uint64_t value);
    /// Writes the window of a windowed walk: items first..end - 1.
    void set_window(std::uint32_t first, std::uint32_t end);
    /// Waits for the device and reads all words.
    void read();
    /// The 64-bit counter whose low word is number `word`, as last read or written.
    std::uint64_t counter(std::size_t word) const {
        return words_[word] | std::uint64_t{words_[word + 1]} << 32;
    }

    /// All words as last read or written; write() brings the device back to them.
    using Words = std::array<std::uint32_t, STATUS_WORDS>;
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
