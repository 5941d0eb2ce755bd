// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "algorithms/orders/order.h"
#include "harness/verify/accuracy/answer_errors.h"
#include "harness/verify/oracle/motion_truth.h"
#include "harness/frames/frames.h"
#include "harness/verify/verification_cache.h"

#include <map>
#include <tuple>

namespace tandem {

/// How much of an answer is compared with the truth.
enum class TruthAmount {
    none,
    pairs,   ///< all pairs: missed and false ones, and decisions
    contacts ///< also depths, normals and points
};

/// An answer for one frame. The functions download it; they are called only when no equal answer was compared
/// before.
struct FrameAnswer {
    Digest pairs, contacts;
    bool makes_contacts = false;
    bool measures = false;                       ///< distances, also of pairs that are apart
    bool has_polygons = false;                   ///< of equal pressure, instead of contacts
    Walked walked = Walked::all;                 ///< pairs of other tetrahedra are in no error
    SelfPairs self = SelfPairs::off;             ///< the bodies whose own tetrahedra are paired
    std::function<std::vector<Pair>()> download; ///< sorted
    std::function<std::vector<ContactPoint>()> download_contacts; ///< sorted
};

/// The truth of a scene's frames, computed once for all cells with the same positions, and the errors of
/// answers, computed once for each distinct answer. The cell's setting `placement` selects the truth. With
/// placement=exact, errors of contacts include the rounding of vertices. With placement=rounded, a second
/// truth by the input tells what rounding changed, unless the cell rounds no vertex of the frame: it takes
/// the memory of the first, and more time where tetrahedra touch, because rationals decide these.
class Truths {
public:
    /// `scene` and `range` must outlive this object. Exact contacts are computed for at most `most_contacts`
    /// pairs of a frame; 0: for all. Errors are stored in the folder between runs of the program, unless it
    /// is empty.
    Truths(const Scene& scene, const FrameRange& range, TruthAmount amount, std::size_t most_contacts,
           const std::filesystem::path& folder = {});

    TruthAmount amount() const { return amount_; }

    /// Errors of a cell's answer for frame number `index` of the range. They depend on the precision,
    /// placement and origin of its geometry. With motion=linear, errors of pairs are those of the pairs that
    /// meet on the way to the next frame; placement must be rounded. Throws InputError without enough memory
    /// for the truth of that frame. For frame 0 it also throws if all frames together would need too much.
    const AnswerErrors& errors(const Geometry& geometry, std::size_t index, const FrameAnswer& answer,
                               const Report& report = {});

private:
    using FramePosition = std::pair<Positions, std::size_t>;
    using Numbers = std::array<std::uint64_t, 6>; ///< of the two digests
    const FrameTruth& truth_of(const FramePosition& position, const Report& report);
    const MotionTruth& motion_truth_of(const FramePosition& position, const Report& report);
    PairErrors motion_errors(const FramePosition& position, const FrameAnswer& answer,
                             std::vector<Pair> pairs, const Report& report);
    const FrameTruth& walked_truth_of(const FramePosition& position, Walked walked, const Report& report);
    RoundedFrame rounded_frame(const FramePosition& cell) const;
    FramePosition input_of(const FramePosition& cell);
    const RoundingErrors& rounding_of(const FramePosition& cell, const FramePosition& position, Walked walked,
                                      const Report& report);
    RoundingErrors input_errors(const Geometry& geometry, const FramePosition& position,
                                const FrameAnswer& answer, std::span<const Pair> pairs, const Report& report);
    const ContactTruths& contact_truths_of(const FramePosition& position, Walked walked,
                                           const FrameTruth& truth);
    std::string cache_key(const Geometry& geometry, const FramePosition& position,
                          const FrameAnswer& answer) const;
    AnswerErrors errors_of(const Geometry& geometry, const FramePosition& position, const FrameAnswer& answer,
                           const Report& report);
    const Drift& drift_of(const Geometry& geometry);

    const Scene& scene_;
    const FrameRange& range_;
    TruthAmount amount_;
    std::size_t most_contacts_;
    VerificationCache cache_;
    std::map<FramePosition, FrameTruth> truths_;
    std::map<FramePosition, MotionTruth> motion_truths_;                 ///< from each frame to the next
    std::map<std::pair<FramePosition, Walked>, FrameTruth> part_truths_; ///< not of Walked::all
    std::map<FramePosition, bool> rounds_; ///< by cell: some vertex is not the input's
    std::map<std::tuple<FramePosition, FramePosition, Walked>, RoundingErrors> roundings_;
    std::map<std::pair<FramePosition, Walked>, ContactTruths> contact_truths_;
    std::map<std::pair<Precision, Origin>, Drift> drifts_; ///< of the first frame
    std::map<std::tuple<Precision, Origin, Motion, FramePosition, Walked, Numbers>, AnswerErrors> errors_;
};

} // namespace tandem
