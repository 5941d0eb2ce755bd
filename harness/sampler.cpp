// SPDX-License-Identifier: MIT
#include "harness/sampler.h"

#include "algorithms/bounds/geometry.h"
#include "scenes/error.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

using Clock = std::chrono::steady_clock;

/// Device time from the begin of the first command to the end of the last; -1 when a command has no times.
std::int64_t device_span(const Trace& trace) {
    std::int64_t first = std::numeric_limits<std::int64_t>::max();
    std::int64_t last = -1;
    for (const auto& event : trace.events) {
        if (event.command == Command::host_work || event.command == Command::wait) continue;
        if (event.begin_ns < 0 || event.device_ns < 0) return -1;
        first = std::min(first, event.begin_ns);
        last = std::max(last, event.begin_ns + event.device_ns);
    }
    return last < 0 ? -1 : last - first;
}

/// One cell at work: the session, and the ways to replay the frames.
class Sampler {
public:
    Sampler(const Cell& cell, const Scene& scene, const FrameRange& range, Measurement& out)
        : cell_(cell), range_(range), out_(out) {
        for (auto* device : cell.devices) device->set_clocks(Clocks::off);
        const auto begin = Clock::now();
        session_ = cell.algorithm->prepare(cell.devices, scene, cell.settings);
        wait();
        out.prepare_ns = since(begin);
        out.settings = session_->settings();
        geometry_ = geometry_of(out.settings);
    }

    void check(References& references, const SampleOptions& options, const std::string& name);
    /// By all devices so far.
    std::uint64_t submissions() const;
    void time();
    void break_down();
    void count();

private:
    FrameResult run(std::size_t index) { return session_->run(range_.frames[index]); }
    void wait() {
        for (auto* device : cell_.devices) device->finish();
    }
    bool makes_contacts() const {
        return out_.settings[parameters::output] == Output::pairs
               && out_.settings[parameters::contact_rule] != ContactRule::none;
    }

    void compare(const ReferenceAnswer& expected, const FrameResult& result, const Digest& digest,
                 const Digest& contacts);
    void add_errors(Truths& truths, std::size_t index, const FrameResult& result, const Digest& digest,
                    const Digest& contacts, const Report& report);
    void add_counts(const FrameResult& result);

    const Cell& cell_;
    const FrameRange& range_;
    Measurement& out_;
    std::unique_ptr<Session> session_;
    Geometry geometry_;
    std::vector<Digest> digests_; ///< [frame] of the checking replay
};

/// Pairs are told apart one by one where there are pairs. With output=count or digest only sums are left: a
/// wrong sum with the right count is at least one pair missing and one too many.
void Sampler::compare(const ReferenceAnswer& expected, const FrameResult& result, const Digest& digest,
                      const Digest& contacts) {
    auto& agreement = out_.agreement;
    ++agreement.frames;
    if (digest != expected.digest) {
        if (result.has_pairs()) {
            const auto found = difference(expected.pairs, result.download());
            agreement.missing += found.missing;
            agreement.extra += found.extra;
        } else {
            agreement.missing +=
                expected.digest.count > result.count ? expected.digest.count - result.count : 0;
            agreement.extra +=
                result.count > expected.digest.count ? result.count - expected.digest.count : 0;
            if (result.count == expected.digest.count) {
                ++agreement.missing;
                ++agreement.extra;
            }
        }
    }
    if (makes_contacts() && contacts != expected.contact_digest) ++agreement.contact_frames_wrong;
}

/// The truth keeps errors by digest, so that the answer is downloaded only when no other cell gave the same.
void Sampler::add_errors(Truths& truths, std::size_t index, const FrameResult& result, const Digest& digest,
                         const Digest& contacts, const Report& report) {
    FrameAnswer answer;
    answer.pairs = digest;
    answer.contacts = contacts;
    answer.makes_contacts = makes_contacts();
    answer.download = [&] { return result.download(); };
    answer.download_contacts = [&] { return result.download_contacts(); };
    if (!out_.errors) out_.errors.emplace();
    out_.errors->add(truths.errors(geometry_, index, answer, report));
}

/// The first replay, which also warms up: kernels compile at their first launch on some devices, buffers grow
/// to their size, and every later sample is held against the digests kept here.
void Sampler::check(References& references, const SampleOptions& options, const std::string& name) {
    session_->reset();
    for (std::size_t i = 0; i < range_.frames.size(); ++i) {
        const auto frame = fmt::format("frame {} of {}", i + 1, range_.frames.size());
        options.progress(fmt::format("{}: checking {}", name, frame));
        const auto result = run(i);
        // output=count makes no digest: its count stands for it, and for the whole where it is right.
        const bool counted = out_.settings[parameters::output] == Output::count;
        auto digest = counted ? Digest{result.count, 0, 0} : result.digest();
        const auto contacts = result.contact_digest();
        if (options.check) {
            const auto& expected = references.answer(geometry_, contact_settings_of(out_.settings), i);
            if (counted && result.count == expected.digest.count) digest = expected.digest;
            compare(expected, result, digest, contacts);
        }
        if (options.truths != nullptr && result.has_pairs())
            add_errors(*options.truths, i, result, digest, contacts,
                       [&](double share, std::uint64_t decided) {
                           options.progress(fmt::format("truth of {}: {:.0f} %, {} pairs decided", frame,
                                                        share * 100, decided));
                       });
        out_.agreement.digest += digest;
        out_.agreement.contact_digest += contacts;
        digests_.push_back(digest);
        add_counts(result);
    }
    for (const auto* device : cell_.devices) out_.device_bytes += device->bytes_allocated();
}

void Sampler::add_counts(const FrameResult& result) {
    out_.body_pairs.push_back(result.body_pairs);
    out_.candidate_pairs.push_back(result.count);
    out_.contacts.push_back(result.contacts);
    out_.degenerate += result.degenerate;
    out_.rejected += result.rejected;
    out_.undecided_by_filter += result.undecided_by_filter;
    out_.undecided_by_double += result.undecided_by_double;
    out_.retries += result.retries;
    out_.batches += result.batches;
}

std::uint64_t Sampler::submissions() const {
    std::uint64_t sum = 0;
    for (const auto* device : cell_.devices) sum += device->submissions();
    return sum;
}

/// One sample. The answer is looked at between the frames, outside the span that is timed.
void Sampler::time() {
    session_->reset();
    out_.submissions = 0;
    std::vector<std::int64_t> frames;
    for (std::size_t i = 0; i < range_.frames.size(); ++i) {
        wait();
        const auto before = submissions();
        const auto begin = Clock::now();
        const auto result = run(i);
        frames.push_back(since(begin));
        out_.submissions += submissions() - before;
        // A sample that gives another answer than the checked replay counts against the cell.
        if (out_.settings[parameters::output] != Output::count && result.digest() != digests_[i])
            ++out_.agreement.extra;
        if (result.count != out_.candidate_pairs[i]) ++out_.agreement.extra;
    }
    out_.total_ns.push_back(std::move(frames));
}

/// One replay with a clock around every command. It is slower than the samples, so that nothing of it goes
/// into the headline.
void Sampler::break_down() {
    session_->reset();
    for (auto* device : cell_.devices) device->set_clocks(Clocks::on);
    for (std::size_t i = 0; i < range_.frames.size(); ++i) {
        wait();
        const auto begin = Clock::now();
        const auto result = run(i);
        out_.breakdown_ns.push_back(since(begin));
        StageSamples sum{};
        std::int64_t span = 0; // the longest of the devices, -1 when one does not tell
        for (auto* device : cell_.devices) {
            const auto trace = device->finish();
            const auto own = by_stage(trace);
            for (std::size_t stage = 0; stage < own.size(); ++stage) sum[stage] += own[stage];
            const auto own_span = device_span(trace);
            span = span < 0 || own_span < 0 ? -1 : std::max(span, own_span);
        }
        out_.stages.push_back(sum);
        out_.device_span_ns.push_back(span);
    }
    if (std::any_of(out_.device_span_ns.begin(), out_.device_span_ns.end(),
                    [](auto span) { return span < 0; }))
        out_.device_span_ns.clear();
    for (auto* device : cell_.devices) device->set_clocks(Clocks::off);
}

/// Kernels that count their work are other kernels; what they take is not measured.
void Sampler::count() {
    session_->reset();
    session_->count_work(true);
    for (std::size_t i = 0; i < range_.frames.size(); ++i) {
        const auto result = run(i);
        for (const auto& counter : cell_.algorithm->counters()) {
            const auto found = result.work.find(counter.name);
            if (found == result.work.end()) continue;
            auto& total = out_.work[counter.name];
            total = counter.total == Counter::Total::sum ? total + found->second : found->second;
        }
    }
    session_->count_work(false);
}

} // namespace

std::int64_t since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
}

StageSample& StageSample::operator+=(const StageSample& other) {
    device_ns += other.device_ns;
    host_ns += other.host_ns;
    launches += other.launches;
    waits += other.waits;
    bytes += other.bytes;
    return *this;
}

StageSamples by_stage(const Trace& trace) {
    StageSamples samples{};
    for (const auto& event : trace.events) {
        auto& sample = samples[static_cast<std::size_t>(event.stage)];
        sample.host_ns += event.host_ns;
        sample.device_ns += std::max<std::int64_t>(event.device_ns, 0);
        sample.launches += event.command == Command::launch ? 1 : 0;
        sample.waits += event.blocked ? 1 : 0;
        const bool moves = event.command == Command::upload || event.command == Command::download;
        sample.bytes += moves ? event.bytes : 0;
    }
    return samples;
}

void check_frames(const Scene& scene, std::size_t first, std::size_t last) {
    if (first <= last && last < scene.frame_count) return;
    const auto wanted = fmt::format("frames {}:{} are impossible", first, last);
    if (first <= last && scene.dynamics)
        throw InputError(
            fmt::format("{}; scene {} moves by simulation and has its start only, frame 0: record it "
                        "with 'tandem simulate {} -o FILE.frames' and name FILE.frames",
                        wanted, scene.name, scene.name));
    if (first <= last && !scene.end.empty()) throw InputError(fmt::format("{}; {}", wanted, scene.end));
    throw InputError(fmt::format("{}; scene {} has frames 0:{}", wanted, scene.name, scene.frame_count - 1));
}

FrameRange make_frames(const Scene& scene, std::size_t first, std::size_t last) {
    check_frames(scene, first, last);
    FrameRange range{first, last, {}};
    for (auto i = first; i <= last; ++i) range.frames.push_back(scene.frame(i));
    return range;
}

const ReferenceAnswer& References::answer(const Geometry& geometry, const ContactSettings& contacts,
                                          std::size_t index) {
    const Key key{geometry, contacts};
    auto found =
        std::find_if(known_.begin(), known_.end(), [&](const auto& entry) { return entry.first == key; });
    if (found == known_.end()) {
        known_.emplace_back(key, std::vector<std::optional<ReferenceAnswer>>(range_.frames.size()));
        found = known_.end() - 1;
    }
    auto& answer = found->second[index];
    if (!answer)
        answer = reference(scene_, range_.frames[index], geometry, true, reference_method(scene_), contacts);
    return *answer;
}

Measurement measure(const Cell& cell, const Scene& scene, const FrameRange& range, References& references,
                    const SampleOptions& options) {
    Measurement out;
    const auto name = describe(cell);
    options.progress(fmt::format("{}: preparing", name));
    // Facts of kernels from here on are those of this cell; the ones of the cells before are dropped.
    for (auto* device : cell.devices) device->take_kernels();
    Sampler sampler(cell, scene, range, out);
    sampler.check(references, options, name);
    for (std::size_t i = 0; i < options.repeat; ++i) {
        options.progress(fmt::format("{}: sample {} of {}", name, i + 1, options.repeat));
        sampler.time();
    }
    options.progress(fmt::format("{}: breakdown", name));
    sampler.break_down();
    if (options.count_work) sampler.count();
    for (auto* device : cell.devices) {
        const auto own = device->take_kernels();
        out.kernels.insert(out.kernels.end(), own.begin(), own.end());
    }
    return out;
}

} // namespace tandem
