// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"
#include "algorithms/answer/growable_buffer.h"
#include "algorithms/bodies/bodies.h"
#include "algorithms/traversal.h"

namespace tandem {

/// The buffers that one answer lies in.
struct AnswerBuffers {
    GrowableBuffer pairs;    ///< rows of pairs.clh, in the bodies' pair_layout()
    GrowableBuffer contacts; ///< columns of ContactColumn; none where there are to be no contacts
};

/// The columns of contacts (contact_rows.clh).
enum ContactColumn : std::size_t {
    contact_ids,   ///< 2 words: pair, feature
    contact_values ///< 8 reals: point, normal, depth, padding
};

/// PAIR_WORDS of pairs.clh.
constexpr std::size_t words_of(PairLayout layout) { return layout == PairLayout::slots ? 2 : 4; }

/// What it takes to answer questions about pairs and contacts: kernels, and the bodies they are of. Shared by
/// a session and its results.
class AnswerTools {
public:
    /// `contacts`: whether there will be any; their kernel is compiled only then. Throws DeviceError.
    AnswerTools(std::shared_ptr<const Bodies> bodies, LaunchShape shape, bool contacts);

    /// Of the first rows of a buffer. They launch, and wait for the sums.
    Digest digest(const Buffer& pairs, std::uint64_t count) const;
    Digest contact_digest(const AnswerBuffers& buffers, std::uint64_t contacts) const;
    /// As AnswerPart::count_by_body.
    void count_by_body(const Buffer& pairs, std::uint64_t count, std::vector<std::uint64_t>& counts) const;
    /// As AnswerPart::expand, of any buffer of rows.
    void expand(const Buffer& pairs, std::uint64_t first, std::uint64_t count, const Buffer& expanded) const;
    /// The first rows of a buffer in input order's numbers, appended; waits for them.
    void download(const Buffer& pairs, std::uint64_t count, std::vector<Pair>& out) const;
    /// A row of pairs.clh, of row_words() words, which numbers tetrahedra by position, as a pair in input
    /// order.
    Pair pair_of(const std::uint32_t* row) const;
    PairLayout layout() const { return bodies_->pair_layout(); }
    std::size_t row_words() const { return words_of(layout()); }
    Device& device() const { return bodies_->device(); }
    /// Whether contact values are doubles.
    bool in_double() const { return bodies_->geometry().precision == Precision::fp64; }

private:
    /// What the last kernel summed up; waits for it.
    Digest sums(std::uint64_t count) const;

    std::shared_ptr<const Bodies> bodies_;
    LaunchShape shape_;
    Buffer sums_;
    Kernel pairs_kernel_, expand_kernel_, contacts_kernel_, count_kernel_;
};

/// Pairs and contacts that lie in a device's buffers.
std::shared_ptr<const AnswerPart> device_part(std::shared_ptr<const AnswerTools> tools,
                                              std::shared_ptr<const AnswerBuffers> buffers,
                                              std::uint64_t pairs, std::uint64_t contacts);

/// Brings pairs and, of each range of them, contacts to the host's memory.
class HostPart : public AnswerPart {
public:
    /// The first `count` pairs of `buffers`; booked under Stage::read.
    HostPart(std::shared_ptr<const AnswerTools> tools, const AnswerBuffers& buffers, std::uint64_t count);
    /// Appends the first `count` contacts of `buffers`, which are of these pairs.
    void add_contacts(const AnswerBuffers& buffers, std::uint64_t count);

    PairBuffer pairs() const override { return {{}, tools_->layout(), count_, count_}; }
    /// Throws DeviceError: they are on no device.
    void expand(std::uint64_t first, std::uint64_t count, const Buffer& expanded) const override;
    Digest digest() const override;
    Digest contact_digest() const override;
    void append_pairs(std::vector<Pair>& pairs) const override;
    void append_contacts(std::vector<ContactPoint>& contacts) const override;
    void count_by_body(std::vector<std::uint64_t>& counts) const override;

private:
    std::shared_ptr<const AnswerTools> tools_;
    Pair pair(std::uint64_t row) const { return tools_->pair_of(rows_.data() + row * tools_->row_words()); }

    std::uint64_t count_;
    std::vector<std::uint32_t> rows_; ///< words of all pairs
    std::vector<std::array<std::uint32_t, 2>> ids_;
    std::vector<std::byte> values_;
};

/// Buffers that return when the last answer that lies in them is gone, so that an answer outlives the next
/// run and a caller who keeps none costs none.
class AnswerPool {
public:
    /// `pairs` and `contacts`: how many there is room for at first, fewer where a limit is near; contacts 0:
    /// no buffers for them.
    AnswerPool(Device& device, PairLayout layout, std::size_t real_bytes, std::int64_t pairs,
               std::int64_t contacts);

    /// Whether pairs in this layout fit into its rows.
    bool fits(PairLayout layout) const { return pair_bytes_ == words_of(layout) * 4; }
    /// The next buffers taken have room for so many, as far as memory allows.
    void expect(std::uint64_t pairs, double contacts_a_pair);
    /// Buffers that no answer lies in, with as much room as was ever needed. Throws OutOfMemory.
    std::shared_ptr<AnswerBuffers> take();
    /// The same for a frame that did not fit: room for so many, or as much as is free, shared out to pairs
    /// and contacts with a rest for the walk. Buffers that no answer lies in are given up.
    std::shared_ptr<AnswerBuffers> take_what_fits(std::uint64_t pairs, std::uint64_t contacts);

private:
    /// Throws OutOfMemory.
    std::shared_ptr<AnswerBuffers> make(std::uint64_t pairs, std::uint64_t contacts) const;
    void widen(AnswerBuffers& set);
    std::vector<Column> contact_columns() const;
    /// Bytes of one contact, in all columns.
    std::size_t contact_bytes() const;

    Device& device_;
    std::size_t pair_bytes_, real_bytes_;
    bool contacts_;
    std::uint64_t needed_pairs_ = 0, needed_contacts_ = 0; ///< of the next set that is taken
    std::vector<std::shared_ptr<AnswerBuffers>> sets_;
};

} // namespace tandem
