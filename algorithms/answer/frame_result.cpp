// SPDX-License-Identifier: MIT
#include "algorithms/answer/frame_result.h"

#include "base/parallel.h"

namespace tandem {

namespace {

/// Sort key of a contact, and its index before sorting.
struct ContactKey {
    Pair pair;
    std::uint32_t feature = 0;
    std::size_t index = 0;

    auto operator<=>(const ContactKey&) const = default;
};

constexpr std::size_t block = 4096; ///< contacts that a thread processes at a time

template<class Work>
void for_blocks(std::size_t count, const Work& work) {
    parallel_for((count + block - 1) / block, [&](std::size_t part) {
        for (auto i = part * block; i < std::min(count, (part + 1) * block); ++i) work(i);
    });
}

} // namespace

Digest& Digest::operator+=(const Digest& other) {
    count += other.count;
    a += other.a;
    b += other.b;
    return *this;
}

FrameCounts& FrameCounts::operator+=(const FrameCounts& other) {
#define TANDEM_ADD(member, ...) member += other.member;
    TANDEM_FRAME_COUNTS(TANDEM_ADD, TANDEM_ADD)
#undef TANDEM_ADD
    return *this;
}

void FrameResult::add(const FrameCounts& counts, const std::optional<Digest>& digest) {
    *this += counts;
    if (!digest) return;
    if (!summed) summed.emplace();
    *summed += *digest;
}

double FrameResult::contacts_a_pair() const {
    return count == 0 ? 1 : static_cast<double>(contacts) / static_cast<double>(count);
}

Digest FrameResult::digest() const {
    if (summed) return *summed;
    Digest sum;
    for (const auto& part : parts) sum += part->digest();
    sum.count = count;
    return sum;
}

Digest FrameResult::contact_digest() const {
    Digest sum;
    for (const auto& part : parts) sum += part->contact_digest();
    return sum;
}

std::vector<Pair> FrameResult::download() const {
    std::vector<Pair> pairs;
    if (has_pairs()) pairs.reserve(count);
    for (const auto& part : parts) part->append_pairs(pairs);
    parallel_sort(pairs);
    return pairs;
}

std::vector<ContactPoint> FrameResult::download_contacts() const {
    std::vector<ContactPoint> found;
    if (has_pairs()) found.reserve(contacts);
    for (const auto& part : parts) part->append_contacts(found);
    // Sorts keys, because contacts are three times as large.
    std::vector<ContactKey> keys(found.size());
    for_blocks(found.size(), [&](std::size_t i) { keys[i] = {found[i].pair, found[i].feature, i}; });
    parallel_sort(keys);
    std::vector<ContactPoint> sorted(found.size());
    for_blocks(found.size(), [&](std::size_t i) {
        sorted[i] = found[keys[i].index];
        for (std::size_t k = 0; has_points && k < 3; ++k) sorted[i].point[k] += origin[k];
    });
    return sorted;
}

} // namespace tandem
