// SPDX-License-Identifier: MIT
#include "algorithms/pipeline/batches.h"

#include "algorithms/answer/wrench_sums.h"
#include "algorithms/parameters/table.h"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <map>
#include <unordered_map>

namespace tandem {

namespace {

/// The buffer for pairs may grow by this fraction of the available memory before a part is split.
constexpr double growth_fraction = 0.2;

/// Some of a frame's body pairs, or one of them and some items of its body a.
struct Batch {
    std::size_t first = 0, count = 0;
    std::uint32_t item_first = 0, item_end = 0; ///< items of a windowed part; 0, 0: all items

    bool windowed() const { return item_end != 0; }
};

/// Keeps of the contacts of each body pair the one with the least distance, as ClosestStage does: several
/// parts may have found some. Returns how many stay.
std::uint64_t keep_closest(std::span<const std::shared_ptr<HostPart>> parts) {
    struct Place {
        double distance;
        Pair pair;
        std::size_t part, contact;

        auto operator<=>(const Place&) const = default;
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, Place> closest;
    for (std::size_t part = 0; part < parts.size(); ++part) {
        std::vector<ContactPoint> contacts;
        parts[part]->append_contacts(contacts);
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const auto& pair = contacts[i].pair;
            const Place place{contacts[i].depth, pair, part, i};
            const auto [best, is_first] = closest.try_emplace({pair.body_a, pair.body_b}, place);
            if (!is_first) best->second = std::min(best->second, place);
        }
    }
    std::vector<std::vector<std::size_t>> kept(parts.size());
    for (const auto& [bodies, place] : closest) kept[place.part].push_back(place.contact);
    for (std::size_t part = 0; part < parts.size(); ++part) {
        std::ranges::sort(kept[part]);
        parts[part]->keep_contacts(kept[part]);
    }
    return closest.size();
}

/// The poses of all bodies on the device, 12 numbers each.
template<class Real>
std::vector<std::array<Real, 12>> downloaded_poses(const Bodies& bodies) {
    const auto row = pose_reals(bodies.geometry());
    std::vector<Real> numbers(row * bodies.count());
    const StageScope scope(bodies.device(), Stage::read);
    bodies.device().download(bodies.poses(), std::as_writable_bytes(std::span(numbers)));
    std::vector<std::array<Real, 12>> poses(bodies.count());
    for (std::size_t body = 0; body < poses.size(); ++body)
        std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(body * row), 12, poses[body].begin());
    return poses;
}

/// Adds up the polygons of each body pair, as WrenchStage does. Returns how many body pairs there are.
template<class Real>
std::uint64_t add_wrenches(const Bodies& bodies, std::span<const std::shared_ptr<HostPart>> parts) {
    struct Place {
        WrenchSums<Real> sums;
        Pair pair;
        std::size_t part, contact;
    };
    const auto arms = body_arms(bodies.scene());
    const auto poses = downloaded_poses<Real>(bodies);
    std::unordered_map<std::uint32_t, std::uint32_t> indices; // by the numbers of the scene
    for (std::uint32_t i = 0; i < bodies.count(); ++i) indices[number_of(bodies.scene(), i)] = i;
    std::map<std::pair<std::uint32_t, std::uint32_t>, Place> found;
    const auto real = [](const std::array<double, 3>& p) {
        return std::array{static_cast<Real>(p[0]), static_cast<Real>(p[1]), static_cast<Real>(p[2])};
    };
    for (std::size_t part = 0; part < parts.size(); ++part) {
        std::vector<ContactPoint> contacts;
        parts[part]->append_contacts(contacts);
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const auto& one = contacts[i];
            const auto a = indices.at(one.pair.body_a), b = indices.at(one.pair.body_b);
            const auto [best, is_first] =
                found.try_emplace({a, b}, Place{{arms[a], arms[b], poses[a]}, one.pair, part, i});
            best->second.sums.add(real(one.point), real(one.normal), static_cast<Real>(one.depth),
                                  static_cast<Real>(one.pressure));
            if (one.pair < best->second.pair) {
                best->second.pair = one.pair;
                best->second.part = part;
                best->second.contact = i;
            }
        }
    }
    std::vector<std::vector<std::size_t>> kept(parts.size());
    for (const auto& [pair, place] : found) {
        const auto v = place.sums.values();
        parts[place.part]->set_contact(place.contact, place.sums.polygons(),
                                       {v[0], v[1], v[2], v[3], v[4], v[5], v[6], 0});
        kept[place.part].push_back(place.contact);
    }
    for (std::size_t part = 0; part < parts.size(); ++part) {
        std::ranges::sort(kept[part]);
        parts[part]->keep_contacts(kept[part]);
    }
    return found.size();
}

class BatchRun {
public:
    BatchRun(Pipeline& pipeline, const FrameInput* input, std::optional<std::span<const BodyPair>> given);

    FrameResult run(std::uint64_t batches);
    /// After run(): whether all pairs and contacts fit into the current buffers at once.
    bool fits() const { return fits_; }

private:
    void search(const FrameInput* input);
    void split(const Batch& batch, std::uint64_t ways);
    void split_items(const Batch& batch, std::uint64_t ways);
    void run_batch(const Batch& batch);
    void walk(const Batch& batch);
    void finish_part();
    void make_contacts(HostPart& host, std::uint64_t pairs);
    void add_counts();
    void reduce();
    std::uint32_t items_of(const Batch& batch) const;

    Pipeline& pipeline_;
    std::vector<BodyPair> pairs_;
    std::deque<Batch> todo_;
    std::shared_ptr<AnswerBuffers> answer_;
    std::vector<std::shared_ptr<HostPart>> finished_;
    FrameResult result_;
    bool fits_ = false;
};

BatchRun::BatchRun(Pipeline& pipeline, const FrameInput* input,
                   std::optional<std::span<const BodyPair>> given)
    : pipeline_(pipeline) {
    const auto least = [&](const auto& setting) {
        return static_cast<std::uint64_t>(pipeline.settings[setting]);
    };
    result_.batches = 0;
    if (given)
        pairs_.assign(given->begin(), given->end());
    else
        search(input);
    // The sizes that the frame needs, as counted by the walk that did not fit.
    const auto pairs = std::max(pipeline.status.counter(STATUS_PAIRS), least(parameters::pair_capacity));
    const auto contacts =
        std::max(pipeline.status.counter(STATUS_CONTACTS), least(parameters::contact_capacity));
    answer_ = pipeline_.answers->take_what_fits(pairs, std::max(pairs, contacts));
}

/// Finds all body pairs of the frame, on the device or the host.
void BatchRun::search(const FrameInput* input) {
    if (pipeline_.body_pairs->searched()) {
        pipeline_.status.begin(0);
        pipeline_.body_pairs->launch(pipeline_.status);
        pipeline_.status.read();
    }
    pairs_ = pipeline_.body_pairs->list(input, pipeline_.status);
}

std::uint32_t BatchRun::items_of(const Batch& batch) const {
    return pipeline_.bodies->row(pairs_[batch.first].a).tetrahedron_count;
}

/// Replaces a part that did not fit by `ways` parts. Throws OutOfMemory if it cannot be split.
void BatchRun::split(const Batch& batch, std::uint64_t ways) {
    if (batch.count <= 1) {
        split_items(batch, ways);
        return;
    }
    ways = std::min<std::uint64_t>(ways, batch.count);
    for (auto i = ways; i-- > 0;) {
        const auto first = batch.count * i / ways;
        const auto end = batch.count * (i + 1) / ways;
        todo_.push_front({batch.first + first, end - first});
    }
}

void BatchRun::split_items(const Batch& batch, std::uint64_t ways) {
    const std::uint64_t first = batch.windowed() ? batch.item_first : 0;
    const std::uint64_t count = (batch.windowed() ? batch.item_end : items_of(batch)) - first;
    if (count <= 1)
        throw OutOfMemory(fmt::format("{}: out of memory for the candidate pairs of a single tetrahedron; "
                                      "raise --memory, or use fewer bodies",
                                      pipeline_.device.info().id));
    ways = std::min(ways, count);
    for (auto i = ways; i-- > 0;)
        todo_.push_front({batch.first, 1, static_cast<std::uint32_t>(first + count * i / ways),
                          static_cast<std::uint32_t>(first + count * (i + 1) / ways)});
}

void BatchRun::walk(const Batch& batch) {
    pipeline_.compile(batch.windowed());
    for (bool again = true; again; result_.retries += again ? 1 : 0) {
        pipeline_.body_pairs->begin_part(std::span(pairs_).subspan(batch.first, batch.count));
        pipeline_.status.begin(batch.count);
        if (batch.windowed()) pipeline_.status.set_window(batch.item_first, batch.item_end);
        pipeline_.stages.walker->launch(pipeline_.task(*answer_));
        pipeline_.status.read();
        again = pipeline_.stages.walker->grow(pipeline_.status);
    }
}

/// Adds the counts of a batch. make_contacts() adds contacts, and run() sets the number of body pairs.
void BatchRun::add_counts() {
    auto one = pipeline_.counts(pipeline_.status.words());
    one.contacts = one.body_pairs = 0;
    result_.add(one, one.summed);
    if (pipeline_.counting) pipeline_.stages.walker->report(pipeline_.status, result_.work);
}

/// Makes contacts for consecutive ranges of pairs, so that the contacts of each range fit into their buffer.
void BatchRun::make_contacts(HostPart& host, std::uint64_t pairs) {
    auto& status = pipeline_.status;
    auto words = status.words();
    std::uint64_t step = pairs;
    for (std::uint64_t first = 0; first < pairs;) {
        const auto end = std::min(pairs, first + step);
        status.write(words);
        const ContactRows kept(*answer_);
        const auto& reduction = pipeline_.reduction;
        const bool reduces = reduction && reduction->joins_rows();
        pipeline_.contacts->launch(answer_->pairs.buffer(), reduces ? reduction->source(*answer_) : kept,
                                   first, end, status);
        if (reduces) reduction->launch(*answer_, kept, pairs_.size(), status);
        status.read();
        const auto made = status.counter(STATUS_CONTACTS);
        const auto capacity = answer_->contacts.capacity();
        if (made > capacity) {
            if (step == 1) answer_->contacts.grow(made);
            const auto fraction = static_cast<double>(capacity) / static_cast<double>(made);
            step = std::max<std::uint64_t>(
                1, static_cast<std::uint64_t>(0.9 * fraction * static_cast<double>(end - first)));
            ++result_.retries;
            continue;
        }
        host.add_contacts(*answer_, made);
        result_.contacts += made;
        words = status.words();
        for (const auto counter : {STATUS_CONTACTS, STATUS_REDUCED}) words[counter] = words[counter + 1] = 0;
        first = end;
    }
}

/// Moves a walked part's pairs and contacts to the host.
void BatchRun::finish_part() {
    if (!has_pairs(pipeline_.output)) {
        add_counts();
        return;
    }
    const auto pairs = pipeline_.status.counter(STATUS_PAIRS);
    auto host = std::make_shared<HostPart>(pipeline_.tools, *answer_, pairs);
    const auto contacts = result_.contacts;
    try {
        if (pipeline_.makes_contacts()) make_contacts(*host, pairs);
    } catch (const OutOfMemory&) {
        result_.contacts = contacts;
        throw;
    }
    add_counts();
    finished_.push_back(host);
    result_.parts.push_back(std::move(host));
}

/// Walks a part and finishes it. If it does not fit, replaces it by smaller parts, or enlarges the buffer and
/// repeats it.
void BatchRun::run_batch(const Batch& batch) {
    std::uint64_t ways = 2;
    try {
        walk(batch);
        const auto pairs = pipeline_.status.counter(STATUS_PAIRS);
        const std::uint64_t capacity = answer_->pairs.capacity();
        if (!has_pairs(pipeline_.output) || pairs <= capacity) {
            finish_part();
            return;
        }
        ++result_.retries;
        if (pairs <= rows_within(pipeline_.device, answer_->pairs.row_bytes(), growth_fraction)) {
            answer_->pairs.grow(pairs);
            todo_.push_front(batch);
            return;
        }
        ways = std::max<std::uint64_t>(2, (pairs + pairs / 4) / capacity + 1);
    } catch (const OutOfMemory&) {
        ++result_.retries;
    }
    split(batch, ways);
}

/// Reduces the contacts of all parts.
void BatchRun::reduce() {
    if (pipeline_.reduction->joins_rows())
        result_.contacts = keep_closest(finished_);
    else if (pipeline_.tools->in_double())
        result_.contacts = add_wrenches<double>(*pipeline_.bodies, finished_);
    else
        result_.contacts = add_wrenches<float>(*pipeline_.bodies, finished_);
}

FrameResult BatchRun::run(std::uint64_t batches) {
    result_.body_pairs = pairs_.size();
    if (pipeline_.output == Output::digest) result_.summed.emplace();
    if (!pairs_.empty()) split({0, pairs_.size()}, batches);
    while (!todo_.empty()) {
        const auto batch = todo_.front();
        todo_.pop_front();
        run_batch(batch);
    }
    pipeline_.compile(false);
    // A pair has at most one of the contacts that are reduced.
    const auto contacts = pipeline_.reduction ? result_.count : result_.contacts;
    if (pipeline_.reduction) reduce();
    fits_ = result_.count <= answer_->pairs.capacity()
            && (!pipeline_.makes_contacts() || contacts <= answer_->contacts.capacity());
    result_.batches = std::max<std::uint64_t>(result_.batches, 1);
    return std::move(result_);
}

} // namespace

FrameResult run_in_batches(Pipeline& pipeline, const FrameInput* input,
                           std::optional<std::span<const BodyPair>> given, std::uint64_t& batches) {
    BatchRun run(pipeline, input, given);
    auto result = run.run(batches);
    batches = run.fits() ? 1 : result.batches;
    return result;
}

} // namespace tandem
