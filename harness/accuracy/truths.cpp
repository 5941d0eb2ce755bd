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

const Truths::Known& Truths::known(Precision precision, std::size_t index, const Report& report) {
    const Place place{precision, index};
    if (const auto found = known_.find(place); found != known_.end()) return found->second;
    Known known;
    known.truth = frame_truth(scene_, frames_[index], precision, report, free_memory());
    if (index == 0) check_room(known.truth, frames_.size());
    if (amount_ == TruthAmount::contacts) {
        known.contacts = contact_truths(scene_, frames_[index], precision, known.truth, most_contacts_);
        if (index == 0) known.drift = vertex_drift(scene_, frames_[index], precision);
    }
    return known_.emplace(place, std::move(known)).first->second;
}

const AnswerErrors& Truths::errors(Precision precision, std::size_t index, const FrameAnswer& answer,
                                   const Report& report) {
    const std::pair key{Place{precision, index},
                        Numbers{answer.pairs.count, answer.pairs.a, answer.pairs.b, answer.contacts.count,
                                answer.contacts.a, answer.contacts.b}};
    if (const auto found = errors_.find(key); found != errors_.end()) return found->second;
    return errors_.emplace(key, errors_of(known(precision, index, report), precision, answer)).first->second;
}

/// Kept by the caller only when nothing has thrown: a download may fail, and the next cell asks again.
AnswerErrors Truths::errors_of(const Known& known, Precision precision, const FrameAnswer& answer) {
    AnswerErrors errors;
    const auto pairs = answer.download();
    errors.frames = 1;
    errors.pairs = pair_errors(known.truth, pairs);
    errors.decided = known.truth.decisions;
    errors.drift = known.drift;
    errors.invalid_tetrahedra = known.truth.invalid.size();
    if (!answer.makes_contacts) return errors;
    const auto contacts = answer.download_contacts();
    errors.decisions = decision_matrix(known.truth, pairs, contacts);
    if (!known.contacts) return errors;
    errors.every_contact = known.contacts->every;
    errors.contacts =
        contact_errors(*known.contacts, contacts, precision == Precision::twice ? 0x1p-53 : 0x1p-24);
    return errors;
}

} // namespace tandem
