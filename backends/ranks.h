// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

namespace tandem {

/// A message cannot be transferred. One line: the call, the operation and the reason.
struct RanksError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The ranks (processes) of a job, seen from this one: the part of a message-passing library that frames on
/// several machines need. Messages are bytes. All ranks run one build, so structures are sent as they are in
/// memory. Every function except rank() and size() may throw RanksError. One thread at a time may use it.
class Ranks {
public:
    using Bytes = std::vector<std::byte>; ///< content of a message

    /// Device or host memory to send to a rank or to receive from it.
    struct Piece {
        int rank = 0;           ///< the other rank
        void* memory = nullptr; ///< host or device pointer; not owned
        std::size_t bytes = 0;  ///< size of the memory
    };

    /// A message and its sender.
    struct Received {
        int from = 0; ///< rank of the sender
        Bytes bytes;  ///< content
    };

    virtual ~Ranks() = default;
    Ranks() = default;
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    virtual int rank() const = 0;                 ///< of this process, from 0
    virtual int size() const = 0;                 ///< number of ranks
    bool is_first() const { return rank() == 0; } ///< whether this is rank 0

    // Collective: all ranks call these in the same order.

    /// Copies the bytes of rank `from` to all ranks.
    virtual void broadcast(Bytes& bytes, int from) = 0;
    /// Returns the bytes of every rank, by rank; lengths may differ.
    virtual std::vector<Bytes> gather_to_all(std::span<const std::byte> own) = 0;
    /// Sends message i of `out` to rank i; empty ones are not sent. Returns the received messages by rank.
    virtual std::vector<Bytes> exchange(const std::vector<Bytes>& out) = 0;

    /// Whether messages can be sent directly from this device's memory.
    virtual bool is_gpu_aware(const DeviceInfo& info) const = 0;
    /// Sends and receives pieces in device or host memory. Both ranks of a pair list them in the same order
    /// and sizes. Device work on this memory must be finished.
    virtual void exchange_device(std::span<const Piece> out, std::span<const Piece> in) = 0;

    // Point to point.

    /// Sends one message to rank `to`, for its receive(). May wait until that rank receives it.
    virtual void send(int to, std::span<const std::byte> bytes) = 0;
    /// Waits for the next message of send() from any rank.
    virtual Received receive() = 0;
    /// Whether a message has arrived, so that receive() does not wait.
    virtual bool probe() = 0;

    /// Ends all ranks with this exit code; does not return.
    [[noreturn]] virtual void abort(int code) = 0;
};

} // namespace tandem
