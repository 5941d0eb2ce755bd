// SPDX-License-Identifier: MIT
#include "harness/ranks/orders.h"

#include "algorithms/ranks/bytes.h"

#include <fmt/format.h>

namespace tandem {

void give_order(Ranks& ranks, const Told& told) {
    Ranks::Bytes message;
    append(message, std::span(&told.order, 1));
    append(message, std::span(&told.number, 1));
    append_text(message, told.text);
    ranks.broadcast(message, 0);
}

Told receive_order(Ranks& ranks) {
    Ranks::Bytes message;
    ranks.broadcast(message, 0);
    MessageReader reader(message);
    Told told;
    told.order = reader.read<Order>();
    told.number = reader.read<std::uint64_t>();
    told.text = reader.read_text();
    return told;
}

std::string first_complaint(Ranks& ranks, std::string_view own) {
    Ranks::Bytes message;
    append_text(message, own);
    const auto all = ranks.gather_to_all(message);
    for (std::size_t rank = 0; rank < all.size(); ++rank)
        if (const auto text = MessageReader(all[rank]).read_text(); !text.empty())
            return fmt::format("rank {}: {}", rank, text);
    return {};
}

} // namespace tandem
