// SPDX-License-Identifier: MIT
// soak [--device D] [--frames N] [--seed S]: N frames in sessions of random algorithms, settings, scenes and
// lengths. Several sessions exist at a time, with resets and with results that outlive them. Some have random
// memory limits: their frames run whole, in batches or not at all. Buffers are guarded (support/cells.h).
// Prints one line per tenth. Exit code 1 if an answer differs from that of the same cell on the host without
// a limit, or if memory, open files or device buffers grow. Exit code 3 if a kernel writes past the end of a
// buffer.
#include "harness/program/environment.h"
#include "base/error.h"
#include "tests/support/limited.h"
#include "tests/support/scenes.h"
#include "tests/support/tried.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <unistd.h>

namespace tandem {
namespace {

using namespace support;

std::int64_t resident_bytes() {
    std::int64_t size = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> size >> resident;
    return resident * sysconf(_SC_PAGESIZE);
}

std::size_t open_files() {
    const std::filesystem::directory_iterator files("/proc/self/fd");
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

std::size_t threads() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

/// Few variants, because each is compiled once and sessions are the subject. On the host, which compiles
/// nothing, rule, decision, precision and layout are random as well.
const std::vector<SettingTexts> variants{{{"k", "8"}, {"contact_rule", "opposing"}},
                                         {{"k", "8"}, {"contact_rule", "opposing"}, {"output", "digest"}},
                                         {{"k", "18"}, {"contact_rule", "sat"}, {"decision", "recheck"}}};

/// Resources of the process that must not grow.
struct Resources {
    std::int64_t bytes = resident_bytes();
    std::size_t files = open_files(), tasks = threads();
};

class Soak {
public:
    Soak(Device& on, std::uint64_t seed) : device_(on), random_(seed) {
        for (std::uint32_t i = 0; i < 6; ++i) scenes_.push_back(crowd(i + 1, 3 + 5 * i, 2.0 + i));
        scenes_.push_back(breathing(3));
        scenes_.push_back(breathing(5));
    }

    /// Runs frames until their total is `stop`.
    void run_until(std::uint64_t stop) {
        while (frames_ < stop)
            run_session(
                std::min<std::uint64_t>(stop - frames_, 1 + below(random_.uniform() < 0.9 ? 200 : 5000)));
        results_.clear();
    }

    std::uint64_t frames() const { return frames_; }
    std::uint64_t sessions() const { return sessions_; }
    std::uint64_t limited() const { return limited_; }
    std::uint64_t refusals() const { return refusals_; }
    std::uint64_t batches() const { return batches_; }
    std::uint64_t wrong() const { return wrong_; }

private:
    std::size_t below(std::size_t n) {
        return static_cast<std::size_t>(random_.uniform() * static_cast<double>(n)) % n;
    }

    /// The settings that determine the answer.
    static SettingTexts cell_of(const SettingTexts& given) {
        SettingTexts cell;
        for (const auto* name : {"k", "contact_rule", "decision", "precision"})
            if (const auto found = given.find(name); found != given.end()) cell.insert(*found);
        return cell;
    }

    /// Reference answer of a frame: from an unlimited session on the host, computed once.
    const Answer& expected(std::size_t scene, std::size_t frame, const SettingTexts& given) {
        const auto cell = cell_of(given);
        const auto key = std::tuple(scene, frame, text(cell));
        const auto known = expected_.find(key);
        if (known != expected_.end()) return known->second;
        auto& host = device("host");
        const auto limit = host.memory_limit();
        host.set_memory_limit(Device::no_memory_limit);
        const auto session = prepare_on(host, algorithm("chunked"), scenes_[scene], cell);
        const auto& made = expected_.emplace(key, Answer(session->run(scenes_[scene].frame(frame))));
        host.set_memory_limit(limit);
        return made.first->second;
    }

    /// Random settings of the next session.
    SettingTexts draw_settings(const Traversal& traversal) {
        SettingTexts given = variants[below(variants.size())];
        if (device_.info().id == "host" && below(2) == 0) {
            const auto draw = [&](const Parameter& parameter) {
                const auto words = parameter.choices();
                given[std::string(parameter.name)] = words[below(words.size())].text;
            };
            for (const Parameter* parameter :
                 std::initializer_list<const Parameter*>{&parameters::contact_rule, &parameters::decision,
                                                         &parameters::precision, &parameters::pair_layout})
                draw(*parameter);
        }
        given["work_items"] = "64";
        if (declares(traversal, "queue_bytes")) given["queue_bytes"] = "65536";
        return given;
    }

    /// Runs a session for `length` frames, with a second session second it half of the time.
    void run_session(std::uint64_t length) {
        const auto& traversal = *algorithms()[below(algorithms().size())];
        const auto scene = below(scenes_.size());
        auto given = draw_settings(traversal);
        const auto capacity = std::size_t{1} << (below(13));
        given["pair_capacity"] = given["contact_capacity"] = fmt::format("{}", capacity);
        const auto settings = resolved(traversal, given);
        std::unique_ptr<Session> session, second;
        try {
            session = prepare_on(device_, traversal, scenes_[scene], settings);
            if (below(2) == 0)
                second = prepare_on(device_, traversal, scenes_[(scene + 1) % scenes_.size()], settings);
        } catch (const InputError&) { // incompatible settings
            return;
        }
        ++sessions_;
        const std::vector<Frame> frames{scenes_[scene].frame(0), scenes_[scene].frame(1)};
        for (std::uint64_t i = 0; i < length; ++i) {
            const auto chance = below(200);
            if (chance == 0) session->reset();
            if (chance % 50 == 1) run_limited_session();
            if (chance == 2 && second) second->run(scenes_[(scene + 1) % scenes_.size()].frame(0));
            auto result = session->run(frames[i % 2]);
            ++frames_;
            batches_ += result.batches > 1;
            // A digest costs more than a frame: check the first two and a random selection.
            if (i < 2 || chance < 10) check(result, scene, i % 2, given);
            if (chance < 3) results_.push_back(std::move(result));
            if (results_.size() > 20) results_.pop_front();
        }
    }

    void check(const FrameResult& result, std::size_t scene, std::size_t frame, const SettingTexts& given) {
        const auto& right = expected(scene, frame, given);
        // A digest summed during traversal does not cover contacts.
        const bool same = result.has_pairs() ? Answer(result) == right : result.digest() == right.pairs;
        if (!same) fmt::print(stderr, "wrong: {} frame {}{}\n", scenes_[scene].name, frame, text(given));
        wrong_ += !same;
    }

    /// Frames of a session with a random memory limit, from slightly too little to ten times the minimum:
    /// they run whole, in batches, or end with OutOfMemory.
    void run_limited_session() {
        const auto& traversal = *algorithms()[below(algorithms().size())];
        const auto scene = below(scenes_.size());
        const auto given = draw_settings(traversal);
        const auto frame_count = scenes_[scene].frame_count;
        std::vector<std::size_t> frames(2 + below(8));
        for (auto& frame : frames) {
            frame = below(frame_count);
            expected(scene, frame, given); // before the limit, which may apply to the host
        }
        try {
            const auto least = static_cast<double>(least_bytes(device_, traversal, scenes_[scene], given));
            const Limited limited(
                device_, static_cast<std::size_t>(least * std::pow(10.0, random_.uniform(-0.1, 1.0))));
            const auto session = prepare_on(device_, traversal, scenes_[scene], given);
            for (const auto frame : frames) run_limited(*session, scene, frame, given);
        } catch (const OutOfMemory&) {
            ++refusals_;
        } catch (const InputError&) {} // incompatible settings
    }

    void run_limited(Session& session, std::size_t scene, std::size_t frame, const SettingTexts& given) {
        try {
            const auto result = session.run(scenes_[scene].frame(frame));
            ++limited_;
            batches_ += result.batches > 1;
            check(result, scene, frame, given);
        } catch (const OutOfMemory&) {
            ++refusals_;
        }
    }

    Device& device_;
    Random random_;
    std::vector<Scene> scenes_;
    std::deque<FrameResult> results_;
    std::map<std::tuple<std::size_t, std::size_t, std::string>, Answer> expected_;
    std::uint64_t frames_ = 0, sessions_ = 0, limited_ = 0, refusals_ = 0, batches_ = 0, wrong_ = 0;
};

int run(const std::string& on, std::uint64_t frames, std::uint64_t seed) {
    auto& soaked = device(on);
    fmt::print("soak of {} at {}, seed {}\n", on, version_line(), seed);
    Soak soak(soaked, seed);
    constexpr std::uint64_t parts = 10;
    soak.run_until(frames / parts); // fills caches
    const Resources before;
    const auto device_before = soaked.bytes_allocated();
    for (std::uint64_t part = 2; part <= parts; ++part) {
        soak.run_until(frames * part / parts);
        const Resources now;
        fmt::print("{} frames, {} sessions, {} under a limit, {} in batches, {} out of memory, {} wrong; "
                   "{:+} KiB, {:+} files, "
                   "{:+} threads, {:+} bytes on "
                   "the device\n",
                   soak.frames(), soak.sessions(), soak.limited(), soak.batches(), soak.refusals(),
                   soak.wrong(), (now.bytes - before.bytes) / 1024,
                   static_cast<std::int64_t>(now.files - before.files),
                   static_cast<std::int64_t>(now.tasks - before.tasks),
                   static_cast<std::int64_t>(soaked.bytes_allocated() - device_before));
        std::fflush(stdout);
    }
    const Resources now;
    // Allows for heap fragmentation and for the driver's data per program.
    constexpr std::int64_t most_growth = 64 << 20;
    const bool flat = now.bytes - before.bytes < most_growth && now.files <= before.files
                      && now.tasks <= before.tasks && soaked.bytes_allocated() == device_before;
    fmt::print("{} frames soaked: {} wrong, memory {}\n", soak.frames(), soak.wrong(),
               flat ? "flat" : "grows");
    const bool good = soak.wrong() == 0 && flat;
    if (good || soak.wrong() > 0)
        tried("frames in sessions of random kinds (`soak`)", soak.frames(), "frames", soaked.info().name,
              soak.wrong());
    return good ? 0 : 1;
}

} // namespace
} // namespace tandem

int main(int argc, char** argv) {
    CLI::App app{"frames in sessions of random kinds, for leaks and for answers that change"};
    std::string on = "host";
    std::uint64_t frames = 10000, seed = 1;
    app.add_option("--device", on, "one device")->capture_default_str();
    app.add_option("--frames", frames, "in all")->check(CLI::Range(10, 1000000000))->capture_default_str();
    app.add_option("--seed", seed, "of everything random")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        return tandem::run(on, frames, seed);
    } catch (const std::exception& error) {
        fmt::print(stderr, "soak: {}\n", error.what());
        return 3;
    }
}
