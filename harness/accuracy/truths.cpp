// SPDX-License-Identifier: MIT
#include "harness/accuracy/truths.h"

#include "harness/environment.h"
#include "scenes/error.h"

#include <fmt/format.h>

namespace tandem {

namespace {

/// Refuses early what there will be no room for if the frames to come are like the first.
void check_room(const FrameTruth& first, std::size_t frames) {
    const auto bytes = (first.touching.size() + first.overlapping.size()) * sizeof(Pair) * (frames - 1);
    const auto memory = free_memory();
    constexpr double gib = 1 << 30;
    if (bytes > memory)
        throw InputError(
            fmt::format("the exact truth of {} frames like the first takes {:.2f} GiB more, and {:.2f} GiB "
                        "are free; choose --truth none or fewer frames",
                        frames, static_cast<double>(bytes) / gib, static_cast<double>(memory) / gib));
}

} // namespace

Truths::Known& Truths::known(Precision precision, std::size_t index, const Report& report) {
    const auto [found, added] = known_.try_emplace({precision, index});
    auto& known = found->second;
    if (!added) return known;
    known.truth = frame_truth(scene_, frames_[index], precision, report, free_memory());
    if (known_.size() == 1) check_room(known.truth, frames_.size());
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
