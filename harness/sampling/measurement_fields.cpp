// SPDX-License-Identifier: MIT
#include "harness/sampling/measurement_fields.h"

#include "harness/fields/types.h"

namespace tandem::record_parts {

const Fields<Measurement>& found_counts() {
    static const Fields<Measurement> fields{
        member("walked_tetrahedra", count(),
               "tetrahedra in the hierarchies, summed over bodies; output=contacts may leave out interior "
               "ones, and records without it walked all",
               &Measurement::walked_tetrahedra, {.since = 4}),
        member("body_pairs", counts(), "body pairs of the broad phase, by frame", &Measurement::body_pairs),
        member("candidate_pairs", counts(), "pairs of tetrahedra whose leaf k-DOPs overlap, by frame",
               &Measurement::candidate_pairs),
        member("contacts", counts(), "contacts, by frame", &Measurement::contacts),
        member(
            "dropped_body_pairs", counts(),
            "body pairs with overlapping root k-DOPs that broad=sphere_boxes leaves out, by frame, counted "
            "with the reference; empty without it and for other broad phases",
            &Measurement::dropped_body_pairs, {.since = 4}),
        member("dropped_candidate_pairs", counts(), "candidate pairs of the dropped body pairs, by frame",
               &Measurement::dropped_candidate_pairs, {.since = 4})};
    return fields;
}

const Fields<FrameCounts>& effort_counts() {
    static const Fields<FrameCounts> fields{
        member("without_boundary", count(),
               "candidate pairs without the boundary faces that the contact rule needs, over all frames; "
               "rejected and undecided_* leave them out, and include them in records without it",
               &FrameCounts::without_boundary, {.since = 4}),
        member("rejected", count(), "candidate pairs that were told apart, over all frames",
               &FrameCounts::rejected),
        member("undecided_by_filter", known_count(),
               "candidate pairs that the certified filter could not decide (decision=recheck, exact), over "
               "all frames",
               &FrameCounts::undecided_by_filter, {.since = 2}),
        member(
            "undecided_by_double", known_count(),
            "candidate pairs that double could not decide (decision=recheck, fp64, exact), over all frames",
            &FrameCounts::undecided_by_double, {.since = 2}),
        member("retries", count(),
               "walks that ran again because a buffer was too small, over the frames of the checking replay",
               &FrameCounts::retries),
        member("batches", nullable(integer_from(0)),
               "parts that frames ran in, over the frames of the checking replay: as many as frames unless "
               "memory was short",
               &FrameCounts::batches, {.since = 2})};
    return fields;
}

} // namespace tandem::record_parts
