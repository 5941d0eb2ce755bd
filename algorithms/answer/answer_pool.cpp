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

std::shared_ptr<AnswerBuffers> AnswerPool::take() {
    for (const auto& set : sets_)
        if (set.use_count() == 1) return set;
    const auto& last = *sets_.back();
    sets_.push_back(make(last.pairs.rows(), last.contact_ids.rows()));
    return sets_.back();
}

std::shared_ptr<AnswerBuffers> AnswerPool::take_what_fits(std::uint64_t pairs, std::uint64_t contacts) {
    std::erase_if(sets_, [](const auto& set) { return set.use_count() == 1; });
    const auto contact_rows = std::min(contacts, rows_within(device_, contact_bytes(), contact_share));
    sets_.push_back(make(std::min(pairs, rows_within(device_, pair_bytes_, pair_share)), contact_rows));
    return sets_.back();
}

} // namespace tandem
