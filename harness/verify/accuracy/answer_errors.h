// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/contact_truth.h"
#include "harness/verify/oracle/drift.h"
#include "harness/verify/oracle/frame_truth.h"

#include <optional>

namespace tandem {

/// Errors of contacts against the exact intersections, one sample a pair of tetrahedra that overlaps and has
/// a contact. L is the longest edge of the two, u half the distance from 1 to the next number of the cell's
/// precision (2^-24 or 2^-53).
struct ContactErrors {
    std::uint64_t overlapping = 0; ///< pairs looked at
    std::uint64_t unanswered = 0;  ///< of these without a contact
    std::uint64_t not_finite = 0;  ///< contacts with a number that is not finite; in no sample
    std::vector<double>
        depth_relative; ///< |deepest - exact| / exact, the exact depth that of the least translation
    std::vector<double> depth_ulps;     ///< |deepest - exact| / (u L)
    std::vector<double> normal_degrees; ///< angle of the deepest contact's normal to the nearest optimal one
    std::vector<double> point;          ///< farthest contact point from the exact intersection, / L
    std::vector<double> hausdorff;      ///< contact points against the exact intersection's vertices, / L
    /// |hull - exact| / exact: the volume of the contact points' convex hull against the exact
    /// intersection's. Every rule's points are corners of one inside the other and edges through faces, which
    /// are that intersection's vertices; what a rule leaves out of them is missing here.
    std::vector<double> volume_relative;
    std::uint64_t no_volume = 0; ///< answered pairs whose exact volume rounds to 0; in no sample of volume

    void add(const ContactErrors& other);
};

/// Rows: exactly disjoint, touching, overlapping. Columns: the answer, no contact, contacts of depth 0 at
/// most, a contact inside. Pairs that are no candidates count as answered by no contact; disjoint ones among
/// them are not counted.
using DecisionMatrix = std::array<std::array<std::uint64_t, 3>, 3>;

/// How far answers are from the truth, summed over frames.
struct AnswerErrors {
    std::uint64_t frames = 0;
    PairErrors pairs;
    DecisionCounts decided; ///< by which tier of the oracle
    std::uint64_t invalid_tetrahedra = 0;
    std::optional<DecisionMatrix> decisions; ///< none without contacts
    std::optional<ContactErrors> contacts;   ///< none when not asked for
    std::optional<Drift> drift;              ///< of the first frame; none when contacts were not asked for
    bool every_contact = true;               ///< no pair was left out of `contacts`

    std::uint64_t missed() const { return pairs.missed_touching + pairs.missed_overlapping; }
    std::uint64_t meeting() const { return pairs.touching + pairs.overlapping + missed(); }
    /// Candidates per pair that meets; nothing when none does.
    std::optional<double> candidate_ratio() const;
    /// With 95 % confidence, at most this share of meeting pairs is missed when none of them was: 3 / n
    /// (Hanley and Lippman-Hand 1983). Nothing when one was missed or none meets.
    std::optional<double> missed_upper95() const;

    void add(const AnswerErrors& other);
};

/// The matrix of one frame; `contacts` sorted by pair.
DecisionMatrix decision_matrix(const FrameTruth& truth, std::span<const Pair> candidates,
                               std::span<const ContactPoint> contacts);

/// Exact intersections of pairs that overlap.
struct ContactTruths {
    std::vector<Pair> pairs; ///< sorted
    std::vector<ContactTruth> truths;
    std::vector<double> sizes; ///< L
    bool every = true;         ///< all overlapping pairs of the frame
};

/// At most `most` of the frame's overlapping pairs, evenly spread over their order; 0: all. In the world,
/// where the frame's coordinates count from `origin`.
ContactTruths contact_truths(const Scene& scene, const Frame& frame, Precision precision,
                             const FrameTruth& truth, std::size_t most,
                             const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/// L of one tetrahedron.
double longest_edge(const TetraCorners& corners);

/// Degrees from a contact's normal to the nearest of the best; exact for small angles, where an arc cosine is
/// not. `normals` not empty; none of either need have length 1.
double nearest_angle(std::span<const std::array<double, 3>> normals, const std::array<double, 3>& normal);

/// Errors of one frame's contacts, sorted by pair; `unit` is u.
ContactErrors contact_errors(const ContactTruths& truths, std::span<const ContactPoint> contacts,
                             double unit);

} // namespace tandem
