// SPDX-License-Identifier: MIT
#include "algorithms/answer/answers.h"

#include "algorithms/answer/digest.h"
#include "algorithms/contacts/reference.h"
#include "algorithms/sources.h"
#include "scenes/parallel.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::size_t block = 4096; ///< contacts a core takes at a time

using PairRow = std::array<std::uint32_t, 4>;
using ContactIds = std::array<std::uint32_t, 2>;

template<class Row>
std::vector<Row> rows_of(Device& device, const Buffer& buffer, std::uint64_t count) {
    std::vector<Row> rows(count);
    const StageScope scope(device, Stage::read);
    device.download(buffer, std::as_writable_bytes(std::span(rows)));
    return rows;
}

/// The reals of contact number `index` in rows of 8.
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
}

template<class Real>
Digest digest_of_contacts(const AnswerTools& tools, std::span<const PairRow> rows,
                          std::span<const ContactIds> ids, std::span<const std::byte> values) {
    Digest sum{ids.size(), 0, 0};
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const auto pair = tools.pair_of(rows[ids[i][0]]);
        const auto v = values_of<Real>(values, i);
        const Contact<Real> contact{ids[i][1], {v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6]};
        const auto [a, b] = contact_terms(pair.body_a, pair.tet_a, pair.body_b, pair.tet_b, contact);
        sum.a += a;
        sum.b += b;
    }
    return sum;
}

/// Appends contacts whose rows and values are here, on all cores.
void convert(const AnswerTools& tools, std::span<const PairRow> rows, std::span<const ContactIds> ids,
             std::span<const std::byte> values, std::vector<ContactPoint>& contacts) {
    const auto first = contacts.size();
    contacts.resize(first + ids.size());
    parallel_for((ids.size() + block - 1) / block, [&](std::size_t part) {
        for (auto i = part * block; i < std::min(ids.size(), (part + 1) * block); ++i) {
            auto& contact = contacts[first + i];
            contact.pair = tools.pair_of(rows[ids[i][0]]);
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

    PairBuffer pairs() const override { return {buffers_->pairs.buffer(), pairs_, buffers_->pairs.rows()}; }
    Digest digest() const override { return tools_->digest(buffers_->pairs.buffer(), pairs_); }
    Digest contact_digest() const override { return tools_->contact_digest(*buffers_, contacts_); }

    void append_pairs(std::vector<Pair>& pairs) const override {
        for (const auto& row : rows()) pairs.push_back(tools_->pair_of(row));
    }

    void append_contacts(std::vector<ContactPoint>& contacts) const override {
        if (contacts_ == 0) return;
        auto& device = tools_->device();
        const auto ids = rows_of<ContactIds>(device, buffers_->contact_ids.buffer(), contacts_);
        std::vector<std::byte> values(contacts_ * buffers_->contact_values.row_bytes());
        {
            const StageScope scope(device, Stage::read);
            device.download(buffers_->contact_values.buffer(), values);
        }
        convert(*tools_, rows(), ids, values, contacts);
    }

private:
    std::vector<PairRow> rows() const {
        return rows_of<PairRow>(tools_->device(), buffers_->pairs.buffer(), pairs_);
    }

    std::shared_ptr<const AnswerTools> tools_;
    std::shared_ptr<const AnswerBuffers> buffers_;
    std::uint64_t pairs_, contacts_;
};

} // namespace

AnswerTools::AnswerTools(std::shared_ptr<const Bodies> bodies, LaunchShape shape, bool contacts)
    : bodies_(std::move(bodies)), shape_(shape) {
    const auto defines = row_defines(bodies_->geometry(), shape.group_size);
    sums_ = device().allocate(16, "sums of a digest");
    pairs_kernel_ = device().compile(kernel_source("algorithms/answer/digest.cl"), "digest_pairs", defines);
    if (contacts)
        contacts_kernel_ = device().compile(kernel_source("algorithms/contacts/digest_contacts.cl"),
                                            "digest_contacts", defines);
}

Digest AnswerTools::sums(std::uint64_t count) const {
    std::array<std::uint64_t, 2> sums{};
    device().download(sums_, std::as_writable_bytes(std::span(sums)));
    return {count, sums[0], sums[1]};
}

Digest AnswerTools::digest(const Buffer& pairs, std::uint64_t count) const {
    const StageScope scope(device(), Stage::postprocess);
    device().clear(sums_, 16);
    const std::array<Argument, 5> arguments{pairs, static_cast<std::uint32_t>(count), bodies_->row_table(),
                                            bodies_->ids(), sums_};
    device().launch(pairs_kernel_, {shape_.groups, shape_.group_size}, arguments);
    return sums(count);
}

Digest AnswerTools::contact_digest(const AnswerBuffers& buffers, std::uint64_t contacts) const {
    if (contacts == 0) return {}; // also where there are no buffers for them
    const StageScope scope(device(), Stage::postprocess);
    device().clear(sums_, 16);
    const std::array<Argument, 7> arguments{buffers.pairs.buffer(),
                                            bodies_->row_table(),
                                            bodies_->ids(),
                                            buffers.contact_ids.buffer(),
                                            buffers.contact_values.buffer(),
                                            static_cast<std::uint32_t>(contacts),
                                            sums_};
    device().launch(contacts_kernel_, {shape_.groups, shape_.group_size}, arguments);
    return sums(contacts);
}

Pair AnswerTools::pair_of(const std::array<std::uint32_t, 4>& row) const {
    return {row[0], bodies_->mesh(row[0]).ids[row[2]], row[1], bodies_->mesh(row[1]).ids[row[3]]};
}

std::shared_ptr<const AnswerPart> device_part(std::shared_ptr<const AnswerTools> tools,
                                              std::shared_ptr<const AnswerBuffers> buffers,
                                              std::uint64_t pairs, std::uint64_t contacts) {
    return std::make_shared<DevicePart>(std::move(tools), std::move(buffers), pairs, contacts);
}

HostPart::HostPart(std::shared_ptr<const AnswerTools> tools, const AnswerBuffers& buffers,
                   std::uint64_t count)
    : tools_(std::move(tools)), rows_(rows_of<PairRow>(tools_->device(), buffers.pairs.buffer(), count)) {}

void HostPart::add_contacts(const AnswerBuffers& buffers, std::uint64_t count) {
    auto& device = tools_->device();
    const auto ids = rows_of<ContactIds>(device, buffers.contact_ids.buffer(), count);
    ids_.insert(ids_.end(), ids.begin(), ids.end());
    const auto first = values_.size();
    values_.resize(first + count * buffers.contact_values.row_bytes());
    const StageScope scope(device, Stage::read);
    device.download(buffers.contact_values.buffer(), std::span(values_).subspan(first));
}

/// A part may take most of the host's memory: it is numbered anew a block at a time.
Digest HostPart::digest() const {
    constexpr std::size_t at_a_time = std::size_t{1} << 20;
    Digest sum;
    std::vector<Pair> pairs;
    pairs.reserve(std::min(at_a_time, rows_.size()));
    for (std::size_t first = 0; first < rows_.size(); first += at_a_time) {
        const auto count = std::min(at_a_time, rows_.size() - first);
        pairs.clear();
        for (const auto& row : std::span(rows_).subspan(first, count)) pairs.push_back(tools_->pair_of(row));
        sum += digest_of(pairs);
    }
    return sum;
}

Digest HostPart::contact_digest() const {
    return tools_->in_double() ? digest_of_contacts<double>(*tools_, rows_, ids_, values_)
                               : digest_of_contacts<float>(*tools_, rows_, ids_, values_);
}

void HostPart::append_pairs(std::vector<Pair>& pairs) const {
    for (const auto& row : rows_) pairs.push_back(tools_->pair_of(row));
}

void HostPart::append_contacts(std::vector<ContactPoint>& contacts) const {
    convert(*tools_, rows_, ids_, values_, contacts);
}

} // namespace tandem
