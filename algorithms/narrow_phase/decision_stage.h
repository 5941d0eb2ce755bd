// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/narrow_phase/contact_settings.h"
#include "algorithms/answer/growable_buffer.h"
#include "algorithms/answer/status.h"
#include "algorithms/bodies/bodies.h"
#include "algorithms/narrow_phase/filter.cl.h"
#include "algorithms/narrow_phase/recheck.cl.h"
#include "algorithms/kernels/launch_shape.h"

namespace tandem {

/// Decides with certainty which candidate pairs in a buffer meet: settings decision=recheck, fp64 and exact.
/// STATUS_UNDECIDED_BY_FILTER counts the pairs that the filter could not decide, STATUS_UNDECIDED_BY_DOUBLE
/// those that double could not. Pairs without the boundary faces that the contact rule needs get no verdict
/// and are not counted.
class DecisionStage {
public:
    DecisionStage(const Bodies& bodies, const ContactSettings& settings, LaunchShape shape);

    /// Whether pairs with a certificate need no verdict. decision=fp64 has no certificates.
    bool uses_certificates() const { return decision_ != DecisionPrecision::fp64; }
    /// Reserves verdicts for `pairs` pairs, which the launches below require. Throws OutOfMemory.
    void reserve(std::uint64_t pairs);
    /// Enqueues verdicts for pairs `first`..`end` - 1 of `found`, up to the count in `status`. With
    /// decision=exact it waits for the counts and for the pairs that double cannot decide, if any. It may
    /// then throw OutOfMemory.
    void launch(const Buffer& found, std::uint64_t first, std::uint64_t end, const Status& status);
    /// The same for those pairs that certify_pairs put into list `open`.
    void launch_open(const Buffer& found, std::uint64_t first, std::uint64_t end, const Buffer& open,
                     const Status& status);

    /// One byte per pair, VERDICT_* of candidates.clh.
    const Buffer& verdicts() const { return decided_.buffer(verdict); }

private:
    void filter(const KernelOf<kernels::filter::FilterPairs>& kernel, const Buffer& found,
                std::uint64_t first, std::uint64_t end, const Buffer& open, const Status& status);
    void recheck(const Buffer& found, std::uint64_t first, std::uint64_t end, const Status& status);
    void settle(const Buffer& found, const Status& status);

    const Bodies& bodies_;
    DecisionPrecision decision_;
    LaunchShape shape_;
    /// Columns by pair: verdicts, and numbers of undecided pairs.
    enum DecisionColumn : std::size_t { verdict, undecided_by_double, undecided_by_filter };
    /// The last column, or any buffer if no kernel reads it.
    const Buffer& filtered() const {
        return decided_.buffer(uses_certificates() ? undecided_by_filter : undecided_by_double);
    }
    GrowableBuffer decided_;   ///< by pair
    Buffer corners_, answers_; ///< data of pairs that the host decides; they live until their commands finish
    KernelOf<kernels::filter::FilterPairs> filter_, filter_open_; ///< null without certificates
    KernelOf<kernels::recheck::RecheckPairs> recheck_;
    KernelOf<kernels::recheck::GatherCorners> gather_; ///< these two are null unless decision=exact
    KernelOf<kernels::recheck::SettlePairs> settle_;
};

} // namespace tandem
