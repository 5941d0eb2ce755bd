// SPDX-License-Identifier: MIT
// What the first rank tells the others, one message after the other, and what they answer.
#pragma once

#include "backends/ranks.h"

#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace tandem {

/// Orders; those with an answer are answered by every rank.
enum class Order : std::uint32_t {
    open,     ///< a scene: JSON; answered by what is wrong
    prepare,  ///< a session: JSON; answered by what is wrong
    next,     ///< frame number
    run,      ///< the frame, number of the answer
    reset,    ///< the session
    count,    ///< work: 1 or 0
    clocks,   ///< 1 or 0
    stages,   ///< answered by what the device did
    digests,  ///< of answer number; answered by pairs' and contacts'
    pairs,    ///< of answer number; answered by all of them
    contacts, ///< of answer number; answered by all of them
    counts,   ///< of answer number; answered by candidate pairs by body
    forget,   ///< answer number
    release,  ///< the session
    leave
};

/// An order and its number.
struct Told {
    Order order = Order::leave;
    std::uint64_t number = 0;
    std::string text{}; ///< JSON of open and prepare
};

/// By the first rank, while all others are in receive_order().
void give_order(Ranks& ranks, const Told& told);
Told receive_order(Ranks& ranks);

/// By all ranks: what is wrong on any of them, "rank 2: ..."; empty where nothing is.
std::string first_complaint(Ranks& ranks, std::string_view own);

} // namespace tandem
