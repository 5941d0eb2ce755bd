// SPDX-License-Identifier: MIT
#include "algorithms/answer/answers.h"

#include "algorithms/answer/contact_digest.h"
#include "algorithms/answer/digest.h"
#include "algorithms/answer/order_stage.h"
#include "algorithms/parameters/table.h"
#include "algorithms/kernels/sources.h"
#include "base/parallel.h"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::size_t block = 4096; ///< contacts that a thread converts at a time
/// Pairs of one download.
constexpr std::uint64_t most_expanded = std::uint64_t{1} << 20;
static_assert(sizeof(Pair) == 16, "a row of expand_pairs");

using ContactIds = std::array<std::uint32_t, 2>;

template<class BodyRow>
std::vector<BodyRow> rows_of(Device& device, const Buffer& buffer, std::uint64_t count) {
    std::vector<BodyRow> rows(count);
    const StageScope scope(device, Stage::read);
    device.download(buffer, std::as_writable_bytes(std::span(rows)));
    return rows;
}

/// Row `index` of the contact values, 8 reals a row.
template<class Real>
std::array<Real, 8> values_of(std::span<const std::byte> bytes, std::size_t index) {
    std::array<Real, 8> row{};
    std::memcpy(row.data(), bytes.data() + index * sizeof(row), sizeof(row));
    return row;
}

template<class Real>
void read_values(std::span<const std::byte> bytes, std::size_t index, ContactPoint& contact) {
    const auto row = values_of<Real>(bytes, index);
    for (std::size_t i = 0; i < 3; ++i) {
        contact.point[i] = static_cast<double>(row[i]);
        contact.normal[i] = static_cast<double>(row[3 + i]);
    }
    contact.depth = static_cast<double>(row[6]);
    contact.pressure = static_cast<double>(row[7]);
}

/// `pair_at` returns the pair of a row.
template<class Real, class PairAt>
Digest digest_of_contacts(const PairAt& pair_at, std::span<const ContactIds> ids,
                          std::span<const std::byte> values) {
    Digest sum{ids.size(), 0, 0};
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const Pair pair = pair_at(ids[i][0]);
        const auto v = values_of<Real>(values, i);
        const Contact<Real> contact{ids[i][1], {v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6], v[7]};
        const auto [a, b] = contact_terms(pair.body_a, pair.tet_a, pair.body_b, pair.tet_b, contact);
        sum.a += a;
        sum.b += b;
    }
    return sum;
}

/// Appends contacts from ids and values in the host's memory, in parallel.
template<class PairAt>
void convert(const AnswerTools& tools, const PairAt& pair_at, std::span<const ContactIds> ids,
             std::span<const std::byte> values, std::vector<ContactPoint>& contacts) {
    const auto first = contacts.size();
    contacts.resize(first + ids.size());
    parallel_for((ids.size() + block - 1) / block, [&](std::size_t part) {
        for (auto i = part * block; i < std::min(ids.size(), (part + 1) * block); ++i) {
            auto& contact = contacts[first + i];
            contact.pair = pair_at(ids[i][0]);
            contact.feature = ids[i][1];
            if (tools.in_double())
                read_values<double>(values, i, contact);
            else
                read_values<float>(values, i, contact);
        }
    });
}

class DevicePart final : public AnswerPart {
public:
    DevicePart(std::shared_ptr<const AnswerTools> tools, std::shared_ptr<const AnswerBuffers> buffers,
               std::uint64_t pairs, std::uint64_t contacts)
        : tools_(std::move(tools)), buffers_(std::move(buffers)), pairs_(pairs), contacts_(contacts) {}

    PairBuffer pairs() const override {
        return {buffers_->pairs.buffer(), tools_->layout(), pairs_, buffers_->pairs.capacity()};
    }
    void expand(std::uint64_t first, std::uint64_t count, const Buffer& expanded) const override {
        check_rows(first, count, expanded);
        tools_->expand(buffers_->pairs.buffer(), first, count, expanded);
    }
    void expand_sorted(const Buffer& expanded) const override {
        check_rows(0, pairs_, expanded);
        if (pairs_ > 0) tools_->expand_sorted(buffers_->pairs.buffer(), pairs_, expanded);
    }
    Digest digest() const override { return tools_->digest(buffers_->pairs.buffer(), pairs_); }
    Digest contact_digest() const override { return tools_->contact_digest(*buffers_, contacts_); }

    void append_pairs(std::vector<Pair>& pairs) const override {
        tools_->download(buffers_->pairs.buffer(), pairs_, pairs);
    }

    void count_by_body(std::vector<std::uint64_t>& counts) const override {
        tools_->count_by_body(buffers_->pairs.buffer(), pairs_, counts);
    }

    void append_contacts(std::vector<ContactPoint>& contacts) const override {
        if (contacts_ == 0) return;
        auto& device = tools_->device();
        const auto& buffer = buffers_->contacts;
        const auto ids = rows_of<ContactIds>(device, buffer.buffer(contact_ids), contacts_);
        std::vector<std::byte> values(contacts_ * buffer.row_bytes(contact_values));
        {
            const StageScope scope(device, Stage::read);
            device.download(buffer.buffer(contact_values), values);
        }
        std::vector<Pair> pairs;
        append_pairs(pairs);
        convert(
            *tools_, [&](std::uint32_t row) { return pairs[row]; }, ids, values, contacts);
    }

private:
    /// Throws DeviceError unless there are these pairs, and `expanded` has room for them.
    void check_rows(std::uint64_t first, std::uint64_t count, const Buffer& expanded) const {
        if (first > pairs_ || count > pairs_ - first || expanded.bytes() / sizeof(Pair) < count)
            throw DeviceError(fmt::format(
                "{}: expand() cannot write pairs {} to {} of {} to a buffer of {} bytes; a pair takes "
                "16 bytes",
                tools_->device().info().id, first, first + count, pairs_, expanded.bytes()));
    }

    std::shared_ptr<const AnswerTools> tools_;
    std::shared_ptr<const AnswerBuffers> buffers_;
    std::uint64_t pairs_, contacts_;
};

} // namespace

AnswerTools::AnswerTools(std::shared_ptr<const Bodies> bodies, LaunchShape shape, bool contacts)
    : bodies_(std::move(bodies)), shape_(shape) {
    auto defines = row_defines(bodies_->geometry(), shape.group_size);
    define(defines, parameters::pair_layout, layout());
    sums_ = device().allocate(16, "sums of a digest");
    compile_kernel(device(), pairs_kernel_, defines);
    compile_kernel(device(), expand_kernel_, defines);
    compile_kernel(device(), count_kernel_, defines);
    if (contacts) compile_kernel(device(), contacts_kernel_, defines);
}

Digest AnswerTools::sums(std::uint64_t count) const {
    std::array<std::uint64_t, 2> sums{};
    device().download(sums_, std::as_writable_bytes(std::span(sums)));
    return {count, sums[0], sums[1]};
}

Digest AnswerTools::digest(const Buffer& pairs, std::uint64_t count) const {
    const StageScope scope(device(), Stage::postprocess);
    device().clear(sums_, 16);
    const kernels::digest::DigestPairs arguments{.found = pairs,
                                                 .count = static_cast<std::uint32_t>(count),
                                                 .owners = bodies_->owners(),
                                                 .ids = bodies_->ids(),
                                                 .sums = sums_};
    device().launch(pairs_kernel_, {shape_.groups, shape_.group_size}, arguments);
    return sums(count);
}

Digest AnswerTools::contact_digest(const AnswerBuffers& buffers, std::uint64_t contacts) const {
    if (contacts == 0) return {}; // buffers for contacts may not exist
    const StageScope scope(device(), Stage::postprocess);
    device().clear(sums_, 16);
    const kernels::digest_contacts::DigestContacts arguments{
        .found = buffers.pairs.buffer(),
        .owners = bodies_->owners(),
        .ids = bodies_->ids(),
        .contact_ids = buffers.contacts.buffer(contact_ids),
        .value_bits = buffers.contacts.buffer(contact_values),
        .count = static_cast<std::uint32_t>(contacts),
        .sums = sums_};
    device().launch(contacts_kernel_, {shape_.groups, shape_.group_size}, arguments);
    return sums(contacts);
}

void AnswerTools::expand(const Buffer& pairs, std::uint64_t first, std::uint64_t count,
                         const Buffer& expanded) const {
    const StageScope scope(device(), Stage::postprocess);
    const kernels::digest::ExpandPairs arguments{.found = pairs,
                                                 .first = static_cast<std::uint32_t>(first),
                                                 .count = static_cast<std::uint32_t>(count),
                                                 .owners = bodies_->owners(),
                                                 .ids = bodies_->ids(),
                                                 .expanded = expanded};
    device().launch(expand_kernel_, {shape_.groups, shape_.group_size}, arguments);
}

void AnswerTools::expand_sorted(const Buffer& pairs, std::uint64_t count, const Buffer& expanded) const {
    OrderStage order(*bodies_, shape_, false);
    Status status(device(), Status::Writes::queued);
    status.set(STATUS_PAIRS, count);
    const auto sorted = device().allocate(count * row_words() * 4, "sorted pairs");
    order.sort_pairs(pairs, static_cast<std::uint32_t>(count), status, sorted);
    expand(sorted, 0, count, expanded);
    device().finish(); // before the buffers are released
}

void AnswerTools::count_by_body(const Buffer& pairs, std::uint64_t count,
                                std::vector<std::uint64_t>& counts) const {
    if (count == 0) return;
    std::vector<std::uint32_t> words(bodies_->count());
    const auto sums = device().allocate(words.size() * 4, "pairs by body");
    const StageScope scope(device(), Stage::postprocess);
    device().clear(sums, words.size() * 4);
    const kernels::digest::CountByBody arguments{.found = pairs,
                                                 .count = static_cast<std::uint32_t>(count),
                                                 .owners = bodies_->owners(),
                                                 .counts = sums};
    device().launch(count_kernel_, {shape_.groups, shape_.group_size}, arguments);
    device().download(sums, std::as_writable_bytes(std::span(words)));
    for (std::size_t body = 0; body < words.size(); ++body) {
        const auto number = number_of(bodies_->scene(), body);
        if (counts.size() <= number) counts.resize(number + std::size_t{1});
        counts[number] += words[body];
    }
}

/// Uses a small buffer for one part at a time, because large answers leave little memory.
void AnswerTools::download(const Buffer& pairs, std::uint64_t count, std::vector<Pair>& out) const {
    if (count == 0) return;
    std::uint64_t rows = std::min(count, most_expanded);
    Buffer expanded;
    while (!expanded) {
        try {
            expanded = device().allocate(rows * sizeof(Pair), "pairs to download");
        } catch (const OutOfMemory&) {
            if (rows == 1) throw;
            rows /= 2;
        }
    }
    const auto begin = out.size();
    out.resize(begin + count);
    for (std::uint64_t first = 0; first < count; first += rows) {
        const auto part = std::min(rows, count - first);
        expand(pairs, first, part, expanded);
        const StageScope scope(device(), Stage::read);
        device().download(expanded, std::as_writable_bytes(std::span(out).subspan(begin + first, part)));
    }
}

Pair AnswerTools::pair_of(const std::uint32_t* row) const {
    const bool slots = layout() == PairLayout::slots;
    const auto a = slots ? bodies_->slot_owner(row[0]) : Bodies::SlotOwner{row[0], row[2]};
    const auto b = slots ? bodies_->slot_owner(row[1]) : Bodies::SlotOwner{row[1], row[3]};
    const auto& scene = bodies_->scene();
    return {number_of(scene, a.body), bodies_->mesh(a.body).ids[a.item], number_of(scene, b.body),
            bodies_->mesh(b.body).ids[b.item]};
}

std::shared_ptr<const AnswerPart> device_part(std::shared_ptr<const AnswerTools> tools,
                                              std::shared_ptr<const AnswerBuffers> buffers,
                                              std::uint64_t pairs, std::uint64_t contacts) {
    return std::make_shared<DevicePart>(std::move(tools), std::move(buffers), pairs, contacts);
}

HostPart::HostPart(std::shared_ptr<const AnswerTools> tools, const AnswerBuffers& buffers,
                   std::uint64_t count)
    : tools_(std::move(tools)),
      count_(count),
      rows_(rows_of<std::uint32_t>(tools_->device(), buffers.pairs.buffer(), count * tools_->row_words())) {}

void HostPart::expand(std::uint64_t, std::uint64_t, const Buffer&) const {
    throw DeviceError("these pairs are in the host's memory and not on a device; use download()");
}

void HostPart::add_contacts(const AnswerBuffers& buffers, std::uint64_t count) {
    auto& device = tools_->device();
    const auto ids = rows_of<ContactIds>(device, buffers.contacts.buffer(contact_ids), count);
    ids_.insert(ids_.end(), ids.begin(), ids.end());
    const auto first = values_.size();
    values_.resize(first + count * buffers.contacts.row_bytes(contact_values));
    const StageScope scope(device, Stage::read);
    device.download(buffers.contacts.buffer(contact_values), std::span(values_).subspan(first));
}

void HostPart::set_contact(std::size_t index, std::uint32_t feature, const std::array<double, 8>& values) {
    ids_[index][1] = feature;
    const auto put = [&]<class Real>(Real) {
        std::array<Real, 8> row;
        std::ranges::transform(values, row.begin(), [](double value) { return static_cast<Real>(value); });
        std::memcpy(values_.data() + index * sizeof(row), row.data(), sizeof(row));
    };
    if (tools_->in_double())
        put(double());
    else
        put(float());
}

void HostPart::keep_contacts(std::span<const std::size_t> kept) {
    if (ids_.empty()) return;
    const auto bytes = values_.size() / ids_.size();
    for (std::size_t i = 0; i < kept.size(); ++i) {
        ids_[i] = ids_[kept[i]];
        std::memmove(values_.data() + i * bytes, values_.data() + kept[i] * bytes, bytes);
    }
    ids_.resize(kept.size());
    values_.resize(kept.size() * bytes);
}

/// Converts the pairs in blocks, because a part may take most of the host's memory.
Digest HostPart::digest() const {
    constexpr std::size_t at_a_time = std::size_t{1} << 20;
    Digest sum;
    std::vector<Pair> pairs;
    pairs.reserve(std::min<std::uint64_t>(at_a_time, count_));
    for (std::uint64_t first = 0; first < count_; first += at_a_time) {
        const auto end = std::min<std::uint64_t>(first + at_a_time, count_);
        pairs.clear();
        for (auto row = first; row < end; ++row) pairs.push_back(pair(row));
        sum += digest_of(pairs);
    }
    return sum;
}

Digest HostPart::contact_digest() const {
    const auto pair_at = [this](std::uint32_t row) { return pair(row); };
    return tools_->in_double() ? digest_of_contacts<double>(pair_at, ids_, values_)
                               : digest_of_contacts<float>(pair_at, ids_, values_);
}

void HostPart::append_pairs(std::vector<Pair>& pairs) const {
    for (std::uint64_t row = 0; row < count_; ++row) pairs.push_back(pair(row));
}

void HostPart::count_by_body(std::vector<std::uint64_t>& counts) const {
    for (std::uint64_t row = 0; row < count_; ++row) {
        const auto one = pair(row);
        counts.resize(std::max<std::size_t>(counts.size(), one.body_b + std::size_t{1}));
        ++counts[one.body_a];
        ++counts[one.body_b];
    }
}

void HostPart::append_contacts(std::vector<ContactPoint>& contacts) const {
    convert(
        *tools_, [this](std::uint32_t row) { return pair(row); }, ids_, values_, contacts);
}

} // namespace tandem
