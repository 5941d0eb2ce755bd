// SPDX-License-Identifier: MIT
#include "harness/accuracy/truths.h"

namespace tandem {

Truths::Known& Truths::known(Precision precision, std::size_t index, const Report& report) {
    const auto [found, added] = known_.try_emplace({precision, index});
    auto& known = found->second;
    if (!added) return known;
    known.truth = frame_truth(scene_, frames_[index], precision, report);
    if (amount_ != TruthAmount::contacts) return known;
    known.contacts = contact_truths(scene_, frames_[index], precision, known.truth, most_contacts_);
    if (index == 0) known.drift = vertex_drift(scene_, frames_[index], precision);
    return known;
}

const AnswerErrors& Truths::errors(Precision precision, std::size_t index, const FrameAnswer& answer,
                                   const Report& report) {
    const Numbers numbers{answer.pairs.count,    answer.pairs.a,    answer.pairs.b,
                          answer.contacts.count, answer.contacts.a, answer.contacts.b};
    const auto [found, added] = errors_.try_emplace({{precision, index}, numbers});
    auto& errors = found->second;
    if (!added) return errors;
    const auto& truth = known(precision, index, report);
    const auto pairs = answer.download();
    errors.frames = 1;
    errors.pairs = pair_errors(truth.truth, pairs);
    errors.decided = truth.truth.decisions;
    errors.drift = truth.drift;
    errors.invalid_tetrahedra = truth.truth.invalid.size();
    if (!answer.makes_contacts) return errors;
    const auto contacts = answer.download_contacts();
    errors.decisions = decision_matrix(truth.truth, pairs, contacts);
    if (!truth.contacts) return errors;
    errors.every_contact = truth.contacts->every;
    errors.contacts =
        contact_errors(*truth.contacts, contacts, precision == Precision::twice ? 0x1p-53 : 0x1p-24);
    return errors;
}

} // namespace tandem
