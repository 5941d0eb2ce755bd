// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "harness/verify/accuracy/answer_errors.h"
#include "harness/plans/frames.h"
#include "harness/verify/verification_cache.h"

#include <map>
#include <tuple>

namespace tandem {

/// How much of an answer is compared with the truth.
enum class TruthAmount {
    none,
    pairs,   ///< every pair: missed, false, decisions
    contacts ///< depths, normals and points as well
};

/// An answer of one frame. The functions bring it to the host; they are called when no equal answer was
/// compared before.
struct FrameAnswer {
    Digest pairs, contacts;
    bool makes_contacts = false;
    std::function<std::vector<Pair>()> download;                  ///< sorted
    std::function<std::vector<ContactPoint>()> download_contacts; ///< sorted
};

/// The truth of a scene's frames, found once for all cells of the same positions, and the errors of answers,
/// found once for each answer: cells that give the same have the same errors. Pairs, contacts and decisions
/// are compared with the truth that the cell's setting `placement` names: with placement=exact what rounding
/// did to the vertices is an error of contacts as well.
class Truths {
public:
    /// `scene` and `range` must outlive it. `most_contacts`: of this many pairs of a frame at most the exact
    /// contact is found, 0 for all.
    /// Errors are kept in the folder from one run of the program to the next; nowhere when it is empty.
    Truths(const Scene& scene, const FrameRange& range, TruthAmount amount, std::size_t most_contacts,
           const std::filesystem::path& folder = {});

    TruthAmount amount() const { return amount_; }

    /// Errors of a cell's answer of frame number `index` of the range. Of its geometry precision, placement
    /// and origin count. Throws InputError when there is too little
    /// memory for the truth of that frame, or, with the first, of as many like it.
    const AnswerErrors& errors(const Geometry& geometry, std::size_t index, const FrameAnswer& answer,
                               const Report& report = {});

private:
    using FramePosition = std::pair<Positions, std::size_t>;
    using Numbers = std::array<std::uint64_t, 6>; ///< of the digests
    const FrameTruth& truth_of(const FramePosition& place, const Report& report);
    const ContactTruths& contact_truths_of(const FramePosition& place, const Report& report);
    std::string question(const Geometry& geometry, const FramePosition& place,
                         const FrameAnswer& answer) const;
    AnswerErrors errors_of(const Geometry& geometry, const FramePosition& place, const FrameAnswer& answer,
                           const Report& report);
    const Drift& drift_of(const Geometry& geometry);

    const Scene& scene_;
    const FrameRange& range_;
    TruthAmount amount_;
    std::size_t most_contacts_;
    VerificationCache kept_;
    std::map<FramePosition, FrameTruth> truths_;
    std::map<FramePosition, ContactTruths> contact_truths_;
    std::map<std::pair<Precision, Origin>, Drift> drifts_; ///< of the first frame
    std::map<std::tuple<Precision, Origin, FramePosition, Numbers>, AnswerErrors> errors_;
};

} // namespace tandem
