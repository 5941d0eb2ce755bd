// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "harness/accuracy/answer_errors.h"

#include <map>

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

/// The truth of a scene's frames, found once for each precision, and the errors of answers, found once for
/// each answer: cells that give the same have the same errors.
class Truths {
public:
    /// `scene` and `frames` must outlive it. `most_contacts`: of this many pairs of a frame at most the exact
    /// contact is found, 0 for all.
    Truths(const Scene& scene, std::span<const Frame> frames, TruthAmount amount, std::size_t most_contacts)
        : scene_(scene), frames_(frames), amount_(amount), most_contacts_(most_contacts) {}

    TruthAmount amount() const { return amount_; }

    /// Errors of an answer of frame number `index` of the span. Throws InputError when there is too little
    /// memory for the truth of that frame, or, with the first, of as many like it.
    const AnswerErrors& errors(Precision precision, std::size_t index, const FrameAnswer& answer,
                               const Report& report = {});

private:
    struct Known {
        FrameTruth truth;
        std::optional<ContactTruths> contacts;
        std::optional<Drift> drift; ///< first frame only
    };
    const Known& known(Precision precision, std::size_t index, const Report& report);
    static AnswerErrors errors_of(const Known& known, Precision precision, const FrameAnswer& answer);

    using Place = std::pair<Precision, std::size_t>;
    using Numbers = std::array<std::uint64_t, 6>; ///< of the digests
    const Scene& scene_;
    std::span<const Frame> frames_;
    TruthAmount amount_;
    std::size_t most_contacts_;
    std::map<Place, Known> known_;
    std::map<std::pair<Place, Numbers>, AnswerErrors> errors_;
};

} // namespace tandem
