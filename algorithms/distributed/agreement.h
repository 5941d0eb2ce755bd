// SPDX-License-Identifier: MIT
// Agreement between ranks that run the same program: an error on one rank is thrown on all ranks, and rank 0
// decides what depends on clocks.
#pragma once

#include "algorithms/distributed/bytes.h"

#include <functional>
#include <type_traits>

namespace tandem {

/// Marks an error that all ranks of the job throw together. Any other error is local to one rank, and the
/// ranks that wait for that rank must be aborted.
struct OfAllRanks {
    virtual ~OfAllRanks() = default;
};

/// An error of type Error that all ranks throw; handlers of Error catch it.
template<class Error>
struct SharedError final : Error, OfAllRanks {
    using Error::Error;
};

// Collectives: all ranks call these functions in the same order.

/// Runs `work` on every rank. When it throws on some ranks, all ranks throw the error of the lowest of them.
/// The message names that rank unless all ranks have the same error.
void run_together(Ranks& ranks, const std::function<void()>& work);

/// Returns the value of rank 0 on every rank.
template<class Value>
Value of_rank_0(Ranks& ranks, const Value& own) {
    static_assert(std::is_trivially_copyable_v<Value>);
    auto message = as_message(std::span(&own, 1));
    ranks.broadcast(message, 0);
    return MessageReader(message).read<Value>();
}
std::string of_rank_0(Ranks& ranks, const std::string& own);

} // namespace tandem
