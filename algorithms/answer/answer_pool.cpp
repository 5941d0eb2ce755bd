// SPDX-License-Identifier: MIT
#include "algorithms/answer/answers.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::size_t id_bytes = 8;    ///< CONTACT_WORDS words
constexpr std::size_t value_reals = 8; ///< CONTACT_REALS

/// Of what is available: for pairs with what decides them, for contacts; a walk grows into the rest.
constexpr double pair_share = 0.2, contact_share = 0.4;

} // namespace

AnswerPool::AnswerPool(Device& device, PairLayout layout, std::size_t real_bytes, std::int64_t pairs,
                       std::int64_t contacts)
    : device_(device), pair_bytes_(words_of(layout) * 4), real_bytes_(real_bytes), contacts_(contacts > 0) {
    sets_.push_back(make(first_rows(device, pairs, pair_bytes_, pair_share),
                         contacts_ ? first_rows(device, contacts, contact_bytes(), contact_share) : 0));
}

std::shared_ptr<AnswerBuffers> AnswerPool::make(std::uint64_t pairs, std::uint64_t contacts) const {
    auto buffers = std::make_shared<AnswerBuffers>();
    buffers->pairs = Room(device_, "candidate pairs", pair_bytes_, pairs);
    if (!contacts_) return buffers;
    buffers->contact_ids = Room(device_, "contact ids", id_bytes, contacts);
    buffers->contact_values = Room(device_, "contact values", value_reals * real_bytes_, contacts);
    return buffers;
}

std::size_t AnswerPool::contact_bytes() const { return id_bytes + value_reals * real_bytes_; }

void AnswerPool::expect(std::uint64_t pairs, double contacts_a_pair) {
    expected_pairs_ = pairs;
    expected_contacts_ =
        contacts_ ? static_cast<std::uint64_t>(static_cast<double>(pairs) * contacts_a_pair) : 0;
}

/// Where memory is short a walk may do with less.
void AnswerPool::widen(AnswerBuffers& set) const {
    const auto widen_one = [](Room& room, std::uint64_t rows) {
        if (rows > room.rows()) room.grow(rows);
    };
    try {
        widen_one(set.pairs, std::min(expected_pairs_, rows_within(device_, pair_bytes_, pair_share)));
        const auto contacts =
            std::min(expected_contacts_, rows_within(device_, contact_bytes(), contact_share));
        widen_one(set.contact_ids, contacts);
        widen_one(set.contact_values, contacts);
    } catch (const OutOfMemory&) {} // the room that there was is there again, or the walk says that it is not
}

std::shared_ptr<AnswerBuffers> AnswerPool::take() {
    auto free = std::ranges::find_if(sets_, [](const auto& set) { return set.use_count() == 1; });
    if (free == sets_.end()) {
        const auto& last = *sets_.back();
        sets_.push_back(make(last.pairs.rows(), last.contact_ids.rows()));
        free = std::prev(sets_.end());
    }
    widen(**free);
    expected_pairs_ = expected_contacts_ = 0;
    return *free;
}

std::shared_ptr<AnswerBuffers> AnswerPool::take_what_fits(std::uint64_t pairs, std::uint64_t contacts) {
    std::erase_if(sets_, [](const auto& set) { return set.use_count() == 1; });
    const auto contact_rows = std::min(contacts, rows_within(device_, contact_bytes(), contact_share));
    sets_.push_back(make(std::min(pairs, rows_within(device_, pair_bytes_, pair_share)), contact_rows));
    return sets_.back();
}

} // namespace tandem
