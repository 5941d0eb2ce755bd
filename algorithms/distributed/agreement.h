// SPDX-License-Identifier: MIT
// Ranks of a job that run the same program: an error of one is an error of all, and rank 0 decides what
// depends on clocks.
#pragma once

#include "algorithms/distributed/bytes.h"

#include <functional>
#include <type_traits>

namespace tandem {

/// Marks an error that every rank of the job throws at once. Any other error is one rank's alone: the ranks
/// that wait for it can only be ended.
struct OfAllRanks {
    virtual ~OfAllRanks() = default;
};

/// An error of that kind, which is caught as what it is.
template<class Error>
struct SharedError final : Error, OfAllRanks {
    using Error::Error;
};

// All ranks call these together, in the same order.

/// Does the work on every rank. Where it throws on some, all throw the error of the first of these, which the
/// message names unless all have the same one.
void run_together(Ranks& ranks, const std::function<void()>& work);

/// The value of rank 0.
template<class Value>
Value of_rank_0(Ranks& ranks, const Value& own) {
    static_assert(std::is_trivially_copyable_v<Value>);
    auto message = as_message(std::span(&own, 1));
    ranks.broadcast(message, 0);
    return MessageReader(message).read<Value>();
}
std::string of_rank_0(Ranks& ranks, const std::string& own);

} // namespace tandem
