// SPDX-License-Identifier: MIT
// Answers brought to the host: never part of a measured frame, but for the sort of the published schedule.
#include "algorithms/kdop_session.h"

#include "scenes/parallel.h"

#include <algorithm>

namespace tandem {

namespace {

template<class Real>
void read_values(std::span<const std::byte> bytes, std::size_t index, ContactPoint& contact) {
    std::array<Real, 8> row{};
    std::memcpy(row.data(), bytes.data() + index * sizeof(row), sizeof(row));
    for (std::size_t i = 0; i < 3; ++i) {
        contact.point[i] = static_cast<double>(row[i]);
        contact.normal[i] = static_cast<double>(row[3 + i]);
    }
    contact.depth = static_cast<double>(row[6]);
}

std::vector<std::array<std::uint32_t, 4>> rows_of(Device& device, const Buffer& buffer, std::uint64_t count) {
    std::vector<std::array<std::uint32_t, 4>> rows(count);
    device.download(buffer, std::as_writable_bytes(std::span(rows)));
    return rows;
}

Pair pair_of(const DeviceScene& scene, const std::array<std::uint32_t, 4>& row) {
    return {row[0], scene.ids(row[0])[row[2]], row[1], scene.ids(row[1])[row[3]]};
}

/// Where a contact stands in order, and where on the device.
struct ContactKey {
    Pair pair;
    std::uint32_t feature = 0, index = 0;

    auto operator<=>(const ContactKey&) const = default;
};

constexpr std::size_t block = 4096; ///< contacts a core takes at a time

} // namespace

std::vector<Pair> KdopSession::download(const FrameResult& result) {
    std::vector<Pair> pairs;
    if (!result.pairs) return pairs;
    for (const auto& row : rows_of(device_, found_, result.count)) pairs.push_back(pair_of(scene_, row));
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

std::vector<ContactPoint> KdopSession::download_contacts(const FrameResult& result) {
    std::vector<ContactPoint> contacts(result.contacts);
    if (contacts.empty()) return contacts;
    const auto rows = rows_of(device_, found_, result.count);
    std::vector<std::array<std::uint32_t, 2>> ids(contacts.size());
    std::vector<std::byte> values(contacts.size() * 8 * real_bytes(scene_.geometry()));
    device_.download(contact_stage_->ids(), std::as_writable_bytes(std::span(ids)));
    device_.download(contact_stage_->values(), values);
    // Keys are sorted instead of contacts, which are three times as large.
    std::vector<ContactKey> keys(contacts.size());
    const auto blocks = (contacts.size() + block - 1) / block;
    parallel_for(blocks, [&](std::size_t part) {
        for (auto i = part * block; i < std::min(contacts.size(), (part + 1) * block); ++i)
            keys[i] = {pair_of(scene_, rows[ids[i][0]]), ids[i][1], static_cast<std::uint32_t>(i)};
    });
    parallel_sort(keys);
    const bool twice = scene_.geometry().precision == Precision::twice;
    parallel_for(blocks, [&](std::size_t part) {
        for (auto i = part * block; i < std::min(contacts.size(), (part + 1) * block); ++i) {
            contacts[i].pair = keys[i].pair;
            contacts[i].feature = keys[i].feature;
            if (twice)
                read_values<double>(values, keys[i].index, contacts[i]);
            else
                read_values<float>(values, keys[i].index, contacts[i]);
        }
    });
    return contacts;
}

/// The original sorts the contacts it read back by pair and position, on one thread (prox.md 2.12).
void KdopSession::sort_contacts(std::uint64_t count) {
    if (!makes_contacts()) return;
    std::vector<std::array<std::uint32_t, 2>> ids(count);
    {
        const StageScope scope(device_, Stage::read);
        device_.download(contact_stage_->ids(), std::as_writable_bytes(std::span(ids)));
    }
    const HostWork work(device_, Stage::postprocess, "sort contacts");
    std::sort(ids.begin(), ids.end());
}

} // namespace tandem
