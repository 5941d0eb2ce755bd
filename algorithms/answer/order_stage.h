// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/answers.h"
#include "algorithms/answer/growable_buffer.h"
#include "algorithms/answer/sort.cl.h"
#include "algorithms/answer/status.h"

namespace tandem {

/// Brings an answer on a device into canonical order: pairs ascend by body a, tetrahedron a, body b and
/// tetrahedron b, contacts by pair and feature, with the numbers of the scene. Grids do not depend on counts.
/// Buffers: 12 to 16 bytes per tetrahedron of the bodies, and 8 per pair. With contacts 12 bytes more per
/// pair, and as many bytes as the contacts have.
class OrderStage {
public:
    /// `bodies` must outlive this. Throws DeviceError for more than 2^32 - 1 tetrahedra.
    OrderStage(const Bodies& bodies, LaunchShape shape, bool contacts);

    /// Enqueues the sort of the pairs that the status counts, before anything refers to their rows. Throws
    /// OutOfMemory.
    void sort_pairs(const AnswerBuffers& answer, const Status& status) {
        const auto& pairs = answer.pairs;
        sort_pairs(pairs.buffer(), pairs.capacity(), status, pairs.buffer());
    }
    /// The same for another buffer of `capacity` rows. Writes the pairs to `sorted`, which may be `found`.
    void sort_pairs(const Buffer& found, std::uint32_t capacity, const Status& status, const Buffer& sorted);
    /// Where the contacts of sorted pairs go until they are sorted. Throws OutOfMemory.
    ContactRows unsorted(const AnswerBuffers& answer);
    /// Enqueues the sort of the contacts in unsorted() into the answer. `reduced`: a reduction writes them,
    /// none if the contacts before it did not fit.
    void sort_contacts(const AnswerBuffers& answer, bool reduced, const Status& status);

private:
    template<class Arguments>
    void launch(const KernelOf<Arguments>& kernel, const std::type_identity_t<Arguments>& arguments) {
        bodies_.device().launch(kernel, {shape_.groups, shape_.group_size}, arguments);
    }
    /// `by_pair`: keys are pairs, of which the answer may have fewer, and counts are masks. `starts` may be
    /// `counts`.
    void start_runs(const Buffer& counts, std::uint32_t keys, bool by_pair, const Status& status,
                    const Buffer& starts);

    const Bodies& bodies_;
    LaunchShape shape_;
    std::uint32_t places_ = 0; ///< tetrahedra of all bodies, in input order
    Buffer firsts_, solids_, table_, sums_;
    GrowableBuffer counts_, pairs_, masks_, contacts_;
    KernelOf<kernels::sort::CountPairs> count_pairs_;
    KernelOf<kernels::sort::SumParts> sum_parts_;
    KernelOf<kernels::sort::StartRuns> start_runs_;
    KernelOf<kernels::sort::ScatterPairs> scatter_pairs_;
    KernelOf<kernels::sort::SortPairs> sort_pairs_;
    // Null without contacts.
    KernelOf<kernels::sort::MarkContacts> mark_contacts_;
    KernelOf<kernels::sort::PlaceContacts> place_contacts_;
};

} // namespace tandem
