// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/digest.cl.h"
#include "algorithms/answer/frame_result.h"
#include "algorithms/answer/growable_buffer.h"
#include "algorithms/bodies/bodies.h"
#include "algorithms/answer/digest_contacts.cl.h"
#include "algorithms/kernels/launch_shape.h"

namespace tandem {

/// The device buffers of one answer.
struct AnswerBuffers {
    GrowableBuffer pairs;    ///< rows of pairs.clh, in the bodies' pair_layout()
    GrowableBuffer contacts; ///< columns of ContactColumn; none if no contacts are made
};

/// The columns of contacts (contact_rows.clh).
enum ContactColumn : std::size_t {
    contact_ids,   ///< 2 words: pair, feature
    contact_values ///< 8 reals: point, normal, depth, padding
};

/// Where contacts are written, up to a capacity.
struct ContactRows {
    const Buffer &ids, &values;
    std::uint32_t capacity;

    ContactRows(const Buffer& id_rows, const Buffer& value_rows, std::uint32_t rows)
        : ids(id_rows), values(value_rows), capacity(rows) {}
    explicit ContactRows(const AnswerBuffers& answer)
        : ContactRows(answer.contacts.buffer(contact_ids), answer.contacts.buffer(contact_values),
                      answer.contacts.capacity()) {}
};

/// Kernels for digests, counts and downloads of pairs and contacts, with the bodies they refer to. A session
/// and its results own it together.
class AnswerTools {
public:
    /// `contacts`: whether to compile the kernel for contacts. Throws DeviceError.
    AnswerTools(std::shared_ptr<const Bodies> bodies, LaunchShape shape, bool contacts);

    /// Digests of the first rows of a buffer. Both launch a kernel and wait for it.
    Digest digest(const Buffer& pairs, std::uint64_t count) const;
    Digest contact_digest(const AnswerBuffers& buffers, std::uint64_t contacts) const;
    /// See AnswerPart::count_by_body.
    void count_by_body(const Buffer& pairs, std::uint64_t count, std::vector<std::uint64_t>& counts) const;
    /// See AnswerPart::expand; for any buffer of rows.
    void expand(const Buffer& pairs, std::uint64_t first, std::uint64_t count, const Buffer& expanded) const;
    /// See AnswerPart::expand_sorted; for the first rows of any buffer.
    void expand_sorted(const Buffer& pairs, std::uint64_t count, const Buffer& expanded) const;
    /// Appends the first rows of a buffer, with ids in input order. Waits for the download.
    void download(const Buffer& pairs, std::uint64_t count, std::vector<Pair>& out) const;
    /// Converts a row of pairs.clh, row_words() words with positions of tetrahedra, to a pair with ids in
    /// input order.
    Pair pair_of(const std::uint32_t* row) const;
    PairLayout layout() const { return bodies_->pair_layout(); }
    std::size_t row_words() const { return words_of(layout()); }
    Device& device() const { return bodies_->device(); }
    /// Whether contact values are doubles.
    bool in_double() const { return bodies_->geometry().precision == Precision::fp64; }

private:
    /// The sums of the last kernel; waits for it.
    Digest sums(std::uint64_t count) const;

    std::shared_ptr<const Bodies> bodies_;
    LaunchShape shape_;
    Buffer sums_;
    KernelOf<kernels::digest::DigestPairs> pairs_kernel_;
    KernelOf<kernels::digest::ExpandPairs> expand_kernel_;
    KernelOf<kernels::digest::CountByBody> count_kernel_;
    KernelOf<kernels::digest_contacts::DigestContacts> contacts_kernel_; ///< null without contacts
};

/// Makes the part for pairs and contacts in a device's buffers.
std::shared_ptr<const AnswerPart> device_part(std::shared_ptr<const AnswerTools> tools,
                                              std::shared_ptr<const AnswerBuffers> buffers,
                                              std::uint64_t pairs, std::uint64_t contacts);

/// Pairs and contacts in the host's memory. Contacts are added range by range of the pairs.
class HostPart : public AnswerPart {
public:
    /// Downloads the first `count` pairs of `buffers`, in Stage::read.
    HostPart(std::shared_ptr<const AnswerTools> tools, const AnswerBuffers& buffers, std::uint64_t count);
    /// Downloads and appends the first `count` contacts of `buffers`, which belong to these pairs.
    void add_contacts(const AnswerBuffers& buffers, std::uint64_t count);

    PairBuffer pairs() const override { return {{}, tools_->layout(), count_, count_}; }
    /// Both throw DeviceError, because the pairs are not on a device.
    void expand(std::uint64_t first, std::uint64_t count, const Buffer& expanded) const override;
    void expand_sorted(const Buffer& expanded) const override { expand(0, count_, expanded); }
    Digest digest() const override;
    Digest contact_digest() const override;
    void append_pairs(std::vector<Pair>& pairs) const override;
    void append_contacts(std::vector<ContactPoint>& contacts) const override;
    void count_by_body(std::vector<std::uint64_t>& counts) const override;

    /// Removes all contacts but these, which are in ascending order.
    void keep_contacts(std::span<const std::size_t> kept);
    /// Replaces feature and values of a contact; the values are numbers of the cell's precision.
    void set_contact(std::size_t index, std::uint32_t feature, const std::array<double, 8>& values);

private:
    std::shared_ptr<const AnswerTools> tools_;
    Pair pair(std::uint64_t row) const { return tools_->pair_of(rows_.data() + row * tools_->row_words()); }

    std::uint64_t count_;
    std::vector<std::uint32_t> rows_; ///< words of all pairs
    std::vector<std::array<std::uint32_t, 2>> ids_;
    std::vector<std::byte> values_;
};

/// A pool of answer buffers. A set is reused when no answer refers to it, so that an answer outlives the next
/// run. A caller that keeps no answers needs one set only.
class AnswerPool {
public:
    /// `pairs` and `contacts`: initial capacities, reduced under a limit of memory. contacts = 0: no buffers
    /// for contacts.
    AnswerPool(Device& device, PairLayout layout, std::size_t real_bytes, std::int64_t pairs,
               std::int64_t contacts);

    /// Whether its rows have the size of pairs in this layout.
    bool fits(PairLayout layout) const { return pair_bytes_ == words_of(layout) * 4; }
    /// Sets the expected size of the next answer: take() then returns that capacity, as far as memory allows.
    void expect(std::uint64_t pairs, double contacts_a_pair);
    /// Returns a set that no answer refers to, with the largest capacity of any set. Throws OutOfMemory.
    std::shared_ptr<AnswerBuffers> take();
    /// The same for a frame that did not fit. Frees unused sets, then limits pairs and contacts to fractions
    /// of the available memory.
    std::shared_ptr<AnswerBuffers> take_what_fits(std::uint64_t pairs, std::uint64_t contacts);

private:
    /// Throws OutOfMemory.
    std::shared_ptr<AnswerBuffers> make(std::uint64_t pairs, std::uint64_t contacts) const;
    void enlarge(AnswerBuffers& set);
    std::vector<Column> contact_columns() const;
    /// Bytes of one contact, in all columns.
    std::size_t contact_bytes() const;

    Device& device_;
    std::size_t pair_bytes_, real_bytes_;
    bool contacts_;
    std::uint64_t needed_pairs_ = 0, needed_contacts_ = 0; ///< minimum capacities of the next take()
    std::vector<std::shared_ptr<AnswerBuffers>> sets_;
};

} // namespace tandem
