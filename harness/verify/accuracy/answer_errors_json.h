// SPDX-License-Identifier: MIT
// JSON form of errors in caches and between processes; records have another form.
#pragma once

#include "harness/verify/accuracy/answer_errors.h"
#include "harness/fields/fields_json.h"

namespace tandem {

TANDEM_FIELDS(PairErrors, candidates, disjoint, touching, overlapping, invalid, missed_touching,
              missed_overlapping)
TANDEM_FIELDS(DecisionCounts, relations, tiers)
TANDEM_FIELDS(Drift, vertices, median, p99, max, of_bound)
TANDEM_FIELDS(ContactErrors, overlapping, unanswered, not_finite, depth_relative, depth_ulps, normal_degrees,
              point, hausdorff, volume_relative, no_volume, distance_ulps, polygon_ulps)
TANDEM_FIELDS(RoundingErrors, meeting, lost, extra, missed, depth_change)
TANDEM_FIELDS(AnswerErrors, frames, pairs, decided, invalid_tetrahedra, decisions, contacts, drift,
              every_contact, rounding)

} // namespace tandem
