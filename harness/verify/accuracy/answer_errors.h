// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/contact_truth.h"
#include "harness/verify/accuracy/rounding.h"
#include "harness/verify/oracle/drift.h"
#include "harness/verify/oracle/frame_truth.h"

#include <optional>

namespace tandem {

/// Errors of contacts against the exact intersections, with one sample for each overlapping pair of
/// tetrahedra that has a contact. L is the longest edge of the two. u is half the distance from 1 to the next
/// number of the cell's precision (2^-24 or 2^-53).
struct ContactErrors {
    std::uint64_t overlapping = 0; ///< compared pairs
    std::uint64_t unanswered = 0;  ///< compared pairs without a contact
    std::uint64_t not_finite = 0;  ///< contacts with a number that is not finite; in no sample
    /// |deepest - exact| / exact; the exact depth is the length of the least translation that separates the
    /// pair.
    std::vector<double> depth_relative;
    std::vector<double> depth_ulps;     ///< |deepest - exact| / (u L)
    std::vector<double> normal_degrees; ///< angle of the deepest contact's normal to the nearest optimal one
    std::vector<double> point;          ///< farthest contact point from the exact intersection, / L
    std::vector<double> hausdorff;      ///< contact points against the exact intersection's vertices, / L
    /// |hull - exact| / exact: volume of the contact points' convex hull against that of the exact
    /// intersection. Contact points of every rule are vertices of the intersection: corners inside the other
    /// tetrahedron, and edges through faces. A rule that omits some of them has a smaller hull.
    std::vector<double> volume_relative;
    std::uint64_t no_volume = 0; ///< answered pairs whose exact volume rounds to 0; in no sample of volume
    /// |distance - exact| / (u L) of pairs that are apart, of rules that measure distances. Their points are
    /// not those of the intersection, and in no sample.
    std::vector<double> distance_ulps;
    /// |area - exact| / (u L^2) of overlapping pairs with a polygon of equal pressure in the answer or
    /// exactly.
    std::vector<double> polygon_ulps;

    void add(const ContactErrors& other);
};

/// Rows are the exact relation: disjoint, touching, overlapping. Columns are the answer: no contact, only
/// contacts without penetration, a contact with penetration. A pair that is not a candidate counts as no
/// contact if it intersects, and is not counted if it is disjoint.
using DecisionMatrix = std::array<std::array<std::uint64_t, 3>, 3>;

/// Errors of answers against the truth, summed over frames.
struct AnswerErrors {
    std::uint64_t frames = 0;
    PairErrors pairs;
    DecisionCounts decided; ///< by tier of the oracle
    std::uint64_t invalid_tetrahedra = 0;
    std::optional<DecisionMatrix> decisions; ///< empty for answers without contacts
    std::optional<ContactErrors> contacts;   ///< empty when not requested
    std::optional<Drift> drift;              ///< of the first frame; empty when contacts are not requested
    bool every_contact = true;               ///< whether `contacts` covers all overlapping pairs
    std::optional<RoundingErrors> rounding;  ///< empty with motion=linear

    std::uint64_t missed() const { return pairs.missed_touching + pairs.missed_overlapping; }
    std::uint64_t meeting() const { return pairs.touching + pairs.overlapping + missed(); }
    /// Candidates per intersecting pair; empty without intersecting pairs.
    std::optional<double> candidate_ratio() const;
    /// Upper bound, with 95 % confidence, of the fraction of intersecting pairs that are missed when no miss
    /// was observed: 3 / n (Hanley and Lippman-Hand 1983). Empty after a miss or without intersecting pairs.
    std::optional<double> missed_upper95() const;

    void add(const AnswerErrors& other);
};

/// The matrix of one frame; `contacts` must be sorted by pair.
DecisionMatrix decision_matrix(const FrameTruth& truth, std::span<const Pair> candidates,
                               std::span<const ContactPoint> contacts);

/// Exact intersections of pairs that overlap.
struct ContactTruths {
    std::vector<Pair> pairs; ///< sorted
    std::vector<ContactTruth> truths;
    std::vector<double> sizes; ///< L
    bool every = true;         ///< whether these are all overlapping pairs of the frame
};

/// Exact intersections of at most `most` overlapping pairs, evenly spread over their order; 0: all. Results
/// are in world coordinates; those of the frame are relative to `origin`.
ContactTruths contact_truths(const Scene& scene, const Frame& frame, Positions positions,
                             const FrameTruth& truth, std::size_t most,
                             const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/// The longest edge (L) of one tetrahedron.
double longest_edge(const TetraCorners& corners);

/// Degrees from a contact's normal to the nearest of the optimal normals. Accurate for small angles, where an
/// arc cosine is not. `normals` must not be empty; no vector needs length 1.
double nearest_angle(std::span<const std::array<double, 3>> normals, const std::array<double, 3>& normal);

/// Errors of one frame's contacts, which must be sorted by pair; `unit` is u. `measures`: of a rule that
/// measures distances.
ContactErrors contact_errors(const ContactTruths& truths, std::span<const ContactPoint> contacts, double unit,
                             bool measures = false);

/// Polygons of equal pressure, sorted by pair, and the pairs that overlap.
struct PolygonAnswer {
    const FrameTruth& truth;
    std::span<const ContactPoint> polygons;
};

/// Errors of the polygons of at most `most` overlapping pairs, evenly spread over their order; 0: all. Pairs
/// that have one exactly but not in the answer are unanswered.
ContactErrors polygon_errors(const Scene& scene, const Frame& frame, Positions positions,
                             const PolygonAnswer& answer, double unit, std::size_t most);

/// Errors of the distances of pairs that are apart, in units of `unit` times the longer edge: of at most
/// `most` contacts, evenly spread over their order; 0: all.
std::vector<double> distance_errors(const Scene& scene, const Frame& frame, Positions positions,
                                    std::span<const ContactPoint> contacts, double unit, std::size_t most);

} // namespace tandem
