// SPDX-License-Identifier: MIT
#include "algorithms/distributed/job_session.h"

#include "algorithms/distributed/agreement.h"

#include <algorithm>
#include <array>

namespace tandem {

namespace {

/// The values of a result that are summed over the ranks.
struct Totals {
    FrameCounts counts;
    bool is_summed = false, has_pairs = false;
    Digest summed;
};

using Parts = std::vector<std::shared_ptr<const AnswerPart>>;

/// The parts of all ranks as one part, which delivers pairs and contacts on rank 0.
class JobPart final : public AnswerPart {
public:
    JobPart(Ranks& ranks, Parts own, std::uint64_t count)
        : ranks_(ranks), own_(std::move(own)), count_(count) {}

    PairBuffer pairs() const override { return {{}, PairLayout::items, count_, count_}; }
    void expand(std::uint64_t, std::uint64_t, const Buffer&) const override {
        throw DeviceError("pairs of several ranks are on no device; download them");
    }
    void expand_sorted(const Buffer& expanded) const override { expand(0, count_, expanded); }
    Digest digest() const override { return digests()[0]; }
    Digest contact_digest() const override { return digests()[1]; }
    void append_pairs(std::vector<Pair>& pairs) const override {
        append_all(pairs, [](const AnswerPart& part, auto& values) { part.append_pairs(values); });
    }
    void append_contacts(std::vector<ContactPoint>& contacts) const override {
        append_all(contacts, [](const AnswerPart& part, auto& values) { part.append_contacts(values); });
    }
    void count_by_body(std::vector<std::uint64_t>& counts) const override {
        std::vector<std::uint64_t> own;
        run_together(ranks_, [&] {
            for (const auto& part : own_) part->count_by_body(own);
        });
        for (const auto& bytes : ranks_.gather_to_all(std::as_bytes(std::span(own)))) {
            const auto numbers = from_message<std::uint64_t>(bytes);
            counts.resize(std::max(counts.size(), numbers.size()));
            for (std::size_t body = 0; body < numbers.size(); ++body) counts[body] += numbers[body];
        }
    }

private:
    using Digests = std::array<Digest, 2>;

    /// Digests of pairs and of contacts; exchanged once.
    const Digests& digests() const {
        if (digests_) return *digests_;
        Digests own{}, all{};
        run_together(ranks_, [&] {
            for (const auto& part : own_) {
                own[0] += part->digest();
                own[1] += part->contact_digest();
            }
        });
        for (const auto& bytes : ranks_.gather_to_all(std::as_bytes(std::span(own)))) {
            const auto digests = MessageReader(bytes).read<Digests>();
            for (std::size_t i = 0; i < all.size(); ++i) all[i] += digests[i];
        }
        return digests_.emplace(all);
    }

    template<class Value, class Append>
    void append_all(std::vector<Value>& values, const Append& append_part) const {
        std::vector<Value> own;
        run_together(ranks_, [&] {
            for (const auto& part : own_) append_part(*part, own);
        });
        std::vector<Ranks::Bytes> out(static_cast<std::size_t>(ranks_.size()));
        out.front() = as_message(std::span(own));
        for (const auto& bytes : ranks_.exchange(out)) {
            const auto received = from_message<Value>(bytes);
            values.insert(values.end(), received.begin(), received.end());
        }
    }

    Ranks& ranks_;
    Parts own_;
    std::uint64_t count_;
    mutable std::optional<Digests> digests_;
};

Ranks::Bytes message_of(const FrameResult& result) {
    const Totals totals{.counts = result,
                        .is_summed = result.summed.has_value(),
                        .has_pairs = result.has_pairs(),
                        .summed = result.summed.value_or(Digest{})};
    auto message = as_message(std::span(&totals, 1));
    for (const auto& [name, count] : result.work) {
        append_text(message, name);
        append(message, std::span(&count, 1));
    }
    return message;
}

/// Adds the result of another rank. A rank without bodies has no counters, so unknown names are skipped. Keys
/// stay the names of this rank, whose lifetime is that of the algorithm.
bool add(FrameResult& result, std::span<const std::byte> message) {
    MessageReader reader(message);
    const auto totals = reader.read<Totals>();
    result.add(totals.counts, totals.is_summed ? std::optional(totals.summed) : std::nullopt);
    while (!reader.is_at_end()) {
        const auto name = reader.read_text();
        const auto count = reader.read<std::uint64_t>();
        for (auto& [own, sum] : result.work)
            if (own == name) sum += count;
    }
    return totals.has_pairs;
}

} // namespace

FrameResult JobSession::do_run(const FrameInput& input, std::optional<std::span<const BodyPair>> body_pairs) {
    auto result = body_pairs ? own_->run(FrameView(input).checked(), *body_pairs)
                             : own_->run(FrameView(input).checked());
    bool has_pairs = result.has_pairs();
    const auto all = ranks_.gather_to_all(message_of(result));
    for (std::size_t rank = 0; rank < all.size(); ++rank)
        if (rank != static_cast<std::size_t>(ranks_.rank())) has_pairs = add(result, all[rank]) || has_pairs;
    if (has_pairs) result.parts = {std::make_shared<JobPart>(ranks_, std::move(result.parts), result.count)};
    return result;
}

} // namespace tandem
