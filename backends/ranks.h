// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

namespace tandem {

/// A message could not be passed: the call, what was being done, and the reason, in one line.
struct RanksError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The processes of a job, of which this is one: what frames that are shared between machines need of a
/// message-passing library, and nothing else. Messages are bytes; all ranks are of one build, so that
/// structures travel as they are. Every function but rank(), size() and is_there() may throw RanksError.
/// Used from one thread at a time.
class Ranks {
public:
    using Bytes = std::vector<std::byte>;

    /// Memory, of a device or of the host, that goes to a rank or comes from it.
    struct Piece {
        int rank = 0;
        void* memory = nullptr;
        std::size_t bytes = 0;
    };

    /// A message, and who sent it.
    struct Received {
        int from = 0;
        Bytes bytes;
    };

    virtual ~Ranks() = default;
    Ranks() = default;
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    virtual int rank() const = 0; ///< of this process, from 0
    virtual int size() const = 0; ///< how many there are
    bool is_first() const { return rank() == 0; }

    // All ranks call these together, in the same order.

    /// Afterwards all have the bytes of rank `from`.
    virtual void broadcast(Bytes& bytes, int from) = 0;
    /// What every rank gave, by rank; lengths may differ.
    virtual std::vector<Bytes> gather_to_all(std::span<const std::byte> own) = 0;
    /// Message i of `out` goes to rank i; empty ones are not sent. Returns what came, by rank.
    virtual std::vector<Bytes> exchange(const std::vector<Bytes>& out) = 0;

    /// Whether messages can be of this device's memory as it lies there.
    virtual bool is_gpu_aware(const DeviceInfo& info) const = 0;
    /// Pieces to and from other ranks, in whatever memory; between two ranks in the same order and of the
    /// same sizes. What devices write there has been waited for.
    virtual void exchange_device(std::span<const Piece> out, std::span<const Piece> in) = 0;

    // Between two of them.

    virtual void send(int to, std::span<const std::byte> bytes) = 0;
    /// Waits for the next message of send(), whoever it is from.
    virtual Received receive() = 0;
    /// The next message where one is there already: then receive() does not wait.
    virtual bool is_there() = 0;

    /// Ends all ranks with this exit code; does not return.
    [[noreturn]] virtual void abort(int code) = 0;
};

} // namespace tandem
