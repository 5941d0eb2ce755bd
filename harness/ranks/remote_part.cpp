// SPDX-License-Identifier: MIT
#include "harness/ranks/remote_part.h"

#include "algorithms/ranks/bytes.h"
#include "harness/ranks/companions.h"

#include <algorithm>
#include <map>
#include <optional>

namespace tandem {

namespace {

/// What adds up of an answer.
struct Totals {
    FrameCounts counts;
    bool is_summed = false, has_parts = false;
    Digest summed;
};

/// An answer of all ranks: those of the others, asked for once.
class RemoteAnswer {
public:
    RemoteAnswer(Ranks& ranks, std::uint64_t number) : ranks_(ranks), number_(number) {}
    ~RemoteAnswer() {
        if (companions() == nullptr) return; // the others have gone
        try {
            give_order(ranks_, {Order::forget, number_});
        } catch (const RanksError&) {
            ranks_.abort(3); // they would wait for ever
        }
    }
    RemoteAnswer(const RemoteAnswer&) = delete;
    RemoteAnswer& operator=(const RemoteAnswer&) = delete;

    /// Of a rank. Digests are few bytes, and kept; the rest is asked for all ranks each time it is asked.
    MessageReader said(Order order, std::size_t rank) {
        auto& all = said_[order];
        if (all.empty()) {
            give_order(ranks_, {order, number_});
            all = ranks_.exchange(std::vector<Ranks::Bytes>(static_cast<std::size_t>(ranks_.size())));
        }
        return MessageReader(all[rank]);
    }

private:
    Ranks& ranks_;
    std::uint64_t number_;
    std::map<Order, std::vector<Ranks::Bytes>> said_;
};

class RemotePart final : public AnswerPart {
public:
    RemotePart(std::shared_ptr<RemoteAnswer> answer, std::size_t rank, std::uint64_t count)
        : answer_(std::move(answer)), rank_(rank), count_(count) {}

    PairBuffer pairs() const override { return {{}, PairLayout::items, count_, count_}; }
    void expand(std::uint64_t, std::uint64_t, const Buffer&) const override {
        throw DeviceError("pairs of another rank are on no device here; download them");
    }
    Digest digest() const override { return answer_->said(Order::digests, rank_).read<Digest>(); }
    Digest contact_digest() const override {
        auto reader = answer_->said(Order::digests, rank_);
        reader.read<Digest>();
        return reader.read<Digest>();
    }
    void append_pairs(std::vector<Pair>& pairs) const override { append_all(Order::pairs, pairs); }
    void append_contacts(std::vector<ContactPoint>& contacts) const override {
        append_all(Order::contacts, contacts);
    }
    void count_by_body(std::vector<std::uint64_t>& counts) const override {
        auto reader = answer_->said(Order::counts, rank_);
        for (std::size_t body = 0; !reader.is_at_end(); ++body) {
            counts.resize(std::max(counts.size(), body + 1));
            counts[body] += reader.read<std::uint64_t>();
        }
    }

private:
    template<class Value>
    void append_all(Order order, std::vector<Value>& values) const {
        auto reader = answer_->said(order, rank_);
        const auto count = reader.read<std::uint64_t>();
        const auto first = values.size();
        values.resize(first + count);
        reader.read(std::span(values).subspan(first));
    }

    std::shared_ptr<RemoteAnswer> answer_;
    std::size_t rank_;
    std::uint64_t count_;
};

template<class Value>
void append_list(Ranks::Bytes& message, const std::vector<Value>& values) {
    const std::uint64_t count = values.size();
    append(message, std::span(&count, 1));
    append(message, std::span(values));
}

} // namespace

Ranks::Bytes totals_of(const FrameResult& result) {
    const Totals totals{.counts = result,
                        .is_summed = result.summed.has_value(),
                        .has_parts = result.has_pairs(),
                        .summed = result.summed.value_or(Digest{})};
    Ranks::Bytes message;
    append(message, std::span(&totals, 1));
    for (const auto& [name, count] : result.work) {
        append_text(message, name);
        append(message, std::span(&count, 1));
    }
    return message;
}

Ranks::Bytes said_of(const FrameResult& result, Order order) {
    Ranks::Bytes message;
    if (order == Order::digests) {
        const std::array digests{result.has_pairs() ? result.digest() : Digest{}, result.contact_digest()};
        append(message, std::span(digests.data(), digests.size()));
    }
    if (order == Order::pairs) {
        std::vector<Pair> pairs;
        for (const auto& part : result.parts) part->append_pairs(pairs);
        append_list(message, pairs);
    }
    if (order == Order::contacts) {
        std::vector<ContactPoint> contacts;
        for (const auto& part : result.parts) part->append_contacts(contacts);
        append_list(message, contacts);
    }
    if (order == Order::counts) {
        std::vector<std::uint64_t> counts;
        for (const auto& part : result.parts) part->count_by_body(counts);
        append(message, std::span(counts));
    }
    return message;
}

void add_remote_parts(FrameResult& result, Ranks& ranks, std::uint64_t number) {
    const auto answer = std::make_shared<RemoteAnswer>(ranks, number);
    const auto all = ranks.gather_to_all({});
    for (std::size_t rank = 1; rank < all.size(); ++rank) {
        MessageReader reader(all[rank]);
        const auto totals = reader.read<Totals>();
        result.add(totals.counts, totals.is_summed ? std::optional(totals.summed) : std::nullopt);
        while (!reader.is_at_end()) {
            const auto name = reader.read_text();
            const auto count = reader.read<std::uint64_t>();
            // By the algorithm's own names, which live as long as it.
            for (auto& [own, sum] : result.work)
                if (own == name) sum += count;
        }
        if (totals.has_parts)
            result.parts.push_back(std::make_shared<RemotePart>(answer, rank, totals.counts.count));
    }
}

} // namespace tandem
