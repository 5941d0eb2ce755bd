// SPDX-License-Identifier: MIT
#include "harness/sampler.h"

#include "algorithms/broad/broad.h"
#include "scenes/error.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

using Clock = std::chrono::steady_clock;

void add(Digest& sum, const Digest& term) {
    sum.count += term.count;
    sum.a += term.a;
    sum.b += term.b;
}

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

/// One cell at work: the session, its broad phase, and the ways to replay the frames.
class Sampler {
public:
    Sampler(const Cell& cell, const Scene& scene, const FrameRange& range, Measurement& out)
        : range_(range), out_(out), device_(*cell.device) {
        device_.set_clocks(Clocks::off);
        device_.finish();
        const auto begin = Clock::now();
        const std::array devices{cell.device};
        session_ = cell.algorithm->prepare(devices, scene, cell.settings);
        device_.finish();
        out.prepare_ns = since(begin);
        out.settings = session_->settings();
        geometry_ = geometry_of(out.settings);
        if (!session_->finds_pairs())
            broad_ = std::make_unique<Broad>(scene, geometry_, broad_bound(out.settings));
    }

    void check(References& references, const SampleOptions& options, const std::string& name);
    void time();
    void break_down();
    void count();

private:
    FrameResult run(std::size_t index) {
        std::vector<BodyPair> pairs;
        if (broad_) {
            const HostWork work(device_, Stage::broad, "body pairs");
            pairs = broad_->pairs(range_.frames[index]);
        }
        return session_->run(range_.frames[index], pairs);
    }

    void compare(const ReferenceAnswer& expected, const FrameResult& result, const Digest& digest,
                 const Digest& contacts);
    void add_errors(Truths& truths, std::size_t index, const FrameResult& result, const Digest& digest,
                    const Digest& contacts, const Report& report);

    const FrameRange& range_;
    Measurement& out_;
    Device& device_;
    std::unique_ptr<Session> session_;
    Geometry geometry_;
    std::unique_ptr<Broad> broad_;
    std::vector<Digest> digests_; ///< [frame] of the checking replay
};

void Sampler::compare(const ReferenceAnswer& expected, const FrameResult& result, const Digest& digest,
                      const Digest& contacts) {
    auto& agreement = out_.agreement;
    ++agreement.frames;
    if (digest != expected.digest) {
        if (result.pairs) {
            const auto found = difference(expected.pairs, session_->download(result));
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
    if (out_.settings.at("contact_rule") != "none" && result.pairs && contacts != expected.contact_digest)
        ++agreement.contact_frames_wrong;
}

void Sampler::add_errors(Truths& truths, std::size_t index, const FrameResult& result, const Digest& digest,
                         const Digest& contacts, const Report& report) {
    FrameAnswer answer;
    answer.pairs = digest;
    answer.contacts = contacts;
    answer.makes_contacts = out_.settings.at("contact_rule") != "none";
    answer.download = [&] { return session_->download(result); };
    answer.download_contacts = [&] { return session_->download_contacts(result); };
    if (!out_.errors) out_.errors.emplace();
    out_.errors->add(truths.errors(geometry_, index, answer, report));
}

void Sampler::check(References& references, const SampleOptions& options, const std::string& name) {
    session_->reset();
    for (std::size_t i = 0; i < range_.frames.size(); ++i) {
        const auto frame = fmt::format("frame {} of {}", i + 1, range_.frames.size());
        options.progress(fmt::format("{}: checking {}", name, frame));
        const auto result = run(i);
        const bool counted = out_.settings.at("output") == "count";
        auto digest = counted ? Digest{result.count, 0, 0} : session_->digest(result);
        const auto contacts = session_->contact_digest(result);
        if (options.check) {
            const auto& expected = references.answer(geometry_, contact_settings_of(out_.settings), i);
            if (counted && result.count == expected.digest.count) digest = expected.digest;
            compare(expected, result, digest, contacts);
        }
        if (options.truths != nullptr && result.pairs)
            add_errors(*options.truths, i, result, digest, contacts,
                       [&](double share, std::uint64_t decided) {
                           options.progress(fmt::format("truth of {}: {:.0f} %, {} pairs decided", frame,
                                                        share * 100, decided));
                       });
        add(out_.agreement.digest, digest);
        add(out_.agreement.contact_digest, contacts);
        digests_.push_back(digest);
        out_.body_pairs.push_back(result.body_pairs);
        out_.candidate_pairs.push_back(result.count);
        out_.contacts.push_back(result.contacts);
        out_.degenerate += result.degenerate;
        out_.rejected += result.rejected;
        out_.unsure += result.unsure;
        out_.uncertain += result.uncertain;
        out_.retries += result.retries;
        device_.finish();
    }
    out_.device_bytes = device_.bytes_allocated();
}

void Sampler::time() {
    session_->reset();
    std::vector<std::int64_t> frames;
    for (std::size_t i = 0; i < range_.frames.size(); ++i) {
        device_.finish();
        const auto begin = Clock::now();
        const auto result = run(i);
        frames.push_back(since(begin));
        // A sample that gives another answer than the checked replay counts against the cell.
        if (out_.settings.at("output") != "count" && session_->digest(result) != digests_[i])
            ++out_.agreement.extra;
        if (result.count != out_.candidate_pairs[i]) ++out_.agreement.extra;
    }
    out_.total_ns.push_back(std::move(frames));
}

void Sampler::break_down() {
    session_->reset();
    device_.set_clocks(Clocks::on);
    for (std::size_t i = 0; i < range_.frames.size(); ++i) {
        device_.finish();
        const auto begin = Clock::now();
        run(i);
        out_.breakdown_ns.push_back(since(begin));
        const auto trace = device_.finish();
        out_.stages.push_back(by_stage(trace));
        out_.device_span_ns.push_back(device_span(trace));
    }
    if (std::any_of(out_.device_span_ns.begin(), out_.device_span_ns.end(),
                    [](auto span) { return span < 0; }))
        out_.device_span_ns.clear();
    device_.set_clocks(Clocks::off);
}

void Sampler::count() {
    session_->reset();
    session_->count_work(true);
    for (std::size_t i = 0; i < range_.frames.size(); ++i) {
        const auto work = run(i).work;
        out_.work.bvtt_nodes += work.bvtt_nodes;
        out_.work.seeds += work.seeds;
        out_.work.balances += work.balances;
        out_.work.refills += work.refills;
        out_.work.spills += work.spills;
        out_.work.queue_bytes = work.queue_bytes;
        out_.work.published_queue_bytes = work.published_queue_bytes;
        device_.finish();
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
    cell.device->take_kernels();
    Sampler sampler(cell, scene, range, out);
    sampler.check(references, options, name);
    for (std::size_t i = 0; i < options.repeat; ++i) {
        options.progress(fmt::format("{}: sample {} of {}", name, i + 1, options.repeat));
        sampler.time();
    }
    options.progress(fmt::format("{}: breakdown", name));
    sampler.break_down();
    if (options.count_work) sampler.count();
    out.kernels = cell.device->take_kernels();
    return out;
}

} // namespace tandem
