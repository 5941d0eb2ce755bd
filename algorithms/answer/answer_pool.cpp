// SPDX-License-Identifier: MIT
#include "algorithms/answer/answers.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace tandem {

namespace {

constexpr std::size_t id_bytes = 8;    ///< CONTACT_WORDS words
constexpr std::size_t value_reals = 8; ///< CONTACT_REALS

/// Fractions of the available memory for pairs and for contacts. The rest is for the walk and for growth.
constexpr double pair_fraction = 0.2, contact_fraction = 0.4;

} // namespace

AnswerPool::AnswerPool(Device& device, PairLayout layout, std::size_t real_bytes, std::int64_t pairs,
                       std::int64_t contacts)
    : device_(device), pair_bytes_(words_of(layout) * 4), real_bytes_(real_bytes), contacts_(contacts > 0) {
    sets_.push_back(make(first_rows(device, pairs, pair_bytes_, pair_fraction),
                         contacts_ ? first_rows(device, contacts, contact_bytes(), contact_fraction) : 0));
}

std::shared_ptr<AnswerBuffers> AnswerPool::make(std::uint64_t pairs, std::uint64_t contacts) const {
    auto buffers = std::make_shared<AnswerBuffers>();
    buffers->pairs = GrowableBuffer(device_, "candidate pairs", pair_bytes_, pairs);
    if (contacts_) buffers->contacts = GrowableBuffer(device_, contact_columns(), contacts);
    return buffers;
}

std::vector<Column> AnswerPool::contact_columns() const {
    return {{"contact ids", id_bytes}, {"contact values", value_reals * real_bytes_}};
}

std::size_t AnswerPool::contact_bytes() const { return id_bytes + value_reals * real_bytes_; }

void AnswerPool::expect(std::uint64_t pairs, double contacts_a_pair) {
    constexpr double spare = 1.125;
    const auto expected = spare * static_cast<double>(pairs);
    needed_pairs_ = static_cast<std::uint64_t>(std::min(expected, static_cast<double>(GrowableBuffer::most)));
    needed_contacts_ = static_cast<std::uint64_t>(
        std::min(contacts_ ? expected * contacts_a_pair : 0.0, static_cast<double>(GrowableBuffer::most)));
}

/// Enlarges a set to the largest capacity of any set and to the expected need. A failure is no error, because
/// the walk may need less.
void AnswerPool::enlarge(AnswerBuffers& set) {
    for (const auto& other : sets_) {
        needed_pairs_ = std::max<std::uint64_t>(needed_pairs_, other->pairs.capacity());
        needed_contacts_ = std::max<std::uint64_t>(needed_contacts_, other->contacts.capacity());
    }
    const auto enlarge_one = [&](GrowableBuffer& buffer, std::uint64_t rows, double fraction) {
        const std::uint64_t capacity = buffer.capacity();
        if (rows > capacity && rows - capacity <= rows_within(device_, buffer.row_bytes(), fraction))
            buffer.reserve(rows);
    };
    try {
        enlarge_one(set.pairs, std::exchange(needed_pairs_, 0), pair_fraction);
        const auto contacts = std::exchange(needed_contacts_, 0);
        if (contacts_) enlarge_one(set.contacts, contacts, contact_fraction);
    } catch (const OutOfMemory&) {} // the previous capacity is restored; if not, the walk reports it
}

std::shared_ptr<AnswerBuffers> AnswerPool::take() {
    auto free = std::ranges::find_if(sets_, [](const auto& set) { return set.use_count() == 1; });
    if (free == sets_.end()) {
        const auto& last = *sets_.back();
        sets_.push_back(make(last.pairs.capacity(), last.contacts.capacity()));
        free = std::prev(sets_.end());
    }
    enlarge(**free);
    return *free;
}

std::shared_ptr<AnswerBuffers> AnswerPool::take_what_fits(std::uint64_t pairs, std::uint64_t contacts) {
    std::erase_if(sets_, [](const auto& set) { return set.use_count() == 1; });
    const auto contact_rows = std::min(contacts, rows_within(device_, contact_bytes(), contact_fraction));
    sets_.push_back(make(std::min(pairs, rows_within(device_, pair_bytes_, pair_fraction)), contact_rows));
    return sets_.back();
}

} // namespace tandem
