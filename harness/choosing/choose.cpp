// SPDX-License-Identifier: MIT
#include "harness/choosing/choose.h"

#include "algorithms/kernels/sources.h"
#include "base/digest.h"
#include "base/private_folder.h"
#include "base/standard_streams.h"
#include "base/whole_file.h"
#include "harness/choosing/choice.h"
#include "harness/choosing/race.h"
#include "harness/plans/device_models.h"
#include "harness/program/environment.h"
#include "harness/program/interrupt.h"
#include "harness/sampling/measurement.h"
#include "harness/plans/cell_session.h"
#include "harness/plans/rank_team.h"
#include "base/statistics.h"

#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;

std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }

/// The logarithm of n to base 4, rounded down; null for 0.
Json power_of_4(std::uint64_t n) { return n == 0 ? Json() : Json((std::bit_width(n) - 1) / 2); }

/// The file of the choice for one question, which processes may share.
class ChoiceFile {
public:
    /// With an empty folder nothing is stored.
    ChoiceFile(const std::filesystem::path& folder, const Json& question) : folder_(folder) {
        const auto built = environment();
        about_ = {{"program", fmt::format("{}{} kernels {}", built.commit, built.dirty ? " changed" : "",
                                          hex(kernel_sources_digest()))},
                  {"question", question}};
        path_ = (folder / fmt::format("choice-{}.json", hex(digest_of(question.dump())))).string();
    }

    const std::string& path() const { return path_; }

    /// The stored choice; null when there is none of this program. A file that cannot be used is a warning.
    Json find(std::string& warning) const {
        std::ifstream file(path_);
        if (folder_.empty() || !file) return {};
        auto json = Json::parse(file, nullptr, false);
        if (json.is_object() && json["digest"] == hex(digest_of(text(json["choice"]))))
            return json["about"] == about_ ? json["choice"] : Json();
        warning = path_ + ": contains no valid choice; choosing again";
        return {};
    }

    /// Replaces the stored choice. Returns an error message of one line; empty on success.
    std::string keep(const Json& choice) const {
        if (folder_.empty()) return {};
        const Json json{{"about", about_}, {"choice", choice}, {"digest", hex(digest_of(text(choice)))}};
        try {
            make_own(folder_);
            WholeFile file(path_);
            file.write(text(json) + "\n");
            file.finish();
        } catch (const std::runtime_error&) {
            return path_ + ": cannot be written; the next run chooses again";
        }
        return {};
    }

private:
    /// Keys of scenes may contain file names that are not UTF-8, which JSON requires.
    static std::string text(const Json& json) {
        return json.dump(1, ' ', false, Json::error_handler_t::replace);
    }

    std::filesystem::path folder_;
    std::string path_;
    Json about_;
};

/// Replays the frames with a session, timed like samples.
Replayed replayed(const Cell& cell, Session& session, const FrameRange& range, std::size_t frames,
                  const ChoosingOptions& options) {
    Replayed sum;
    session.reset();
    for (std::size_t i = 0; i < frames; ++i) {
        if (decided(cell.team, options.stop())) throw Interrupted();
        const auto frame = range.state(i, session.settings()[parameters::motion]);
        for (auto* device : cell.devices) device->finish();
        const auto begin = std::chrono::steady_clock::now();
        const auto result = session.run(FrameView(frame.input()).checked());
        sum.ns += since(begin);
        sum.contacts += result.contacts;
        sum.pairs += cell.team == nullptr ? result.count : 0;
        if (cell.team != nullptr)
            for (const auto& work : result.shared) sum.pairs += work.pairs;
    }
    sum.ns = decided(cell.team, sum.ns);
    if (cell.team == nullptr) return sum;
    const auto own = std::exchange(sum.contacts, 0);
    for (const auto& bytes : cell.team->gather(std::as_bytes(std::span(&own, 1))))
        sum.contacts += MessageReader(bytes).read<std::uint64_t>();
    return sum;
}

/// Replaces the cell by the chosen candidate, unless none has that name any more.
bool settle(Cell& cell, const Json& choice) {
    const auto chosen = std::ranges::find_if(
        cell.candidates, [&](const auto& candidate) { return is_chosen(candidate, choice); });
    if (chosen == cell.candidates.end()) return false;
    auto decided = *chosen;
    decided.chosen = std::make_shared<const Json>(choice);
    cell = std::move(decided);
    return true;
}

void print_choice(const Cell& cell, double limit, const std::string& file) {
    const auto& choice = *cell.chosen;
    const auto& all = choice["candidates"];
    const auto timed =
        std::ranges::count_if(all, [](const auto& one) { return !one["median_ns"].is_null(); });
    auto text = fmt::format("best of {} candidates ({} timed)", all.size(), timed);
    if (!choice["margin"].is_null()) {
        const auto& next = choice["runner_up"];
        text += fmt::format(", {:.1f} % ahead of {} {}", 100 * choice["margin"].get<double>(),
                            next["algorithm"].get<std::string>(), next["preset"].get<std::string>());
        for (const auto& [name, value] : next["settings"].items())
            text += fmt::format(" {}={}", name, value.get<std::string>());
    }
    const auto number = [&](const char* name) { return choice[name].get<double>(); };
    if (choice["from_cache"].get<bool>())
        print_message("auto: {}, stored in {}: {} on {}; --choose-afresh measures again\n", describe(cell),
                      file, text, choice["scene"].get<std::string>());
    else
        print_message("auto: {}: {} on frames {}:{}, in {:.1f} s of replays (at most {:g}) and {:.1f} s of "
                      "preparation\n",
                      describe(cell), text, choice["frames"]["first"].get<std::size_t>(),
                      choice["frames"]["last"].get<std::size_t>(), number("seconds"), limit,
                      number("preparing_seconds"));
}

void warn(const std::string& line) {
    if (!line.empty()) print_message("tandem: {}\n", line);
}

} // namespace

Json question_of(const Cell& cell, const Scene& scene, std::uint64_t pairs) {
    Json devices = Json::array();
    for (const auto* device : cell.devices) {
        const auto limit = device->memory_limit();
        devices.push_back({model_of(device->info()), device->info().compute_units,
                           limit == Device::no_memory_limit ? Json() : Json(limit)});
    }
    if (cell.team != nullptr) // those of the other ranks, without their limits
        for (const auto& info : cell.team->devices()) devices.push_back(model_of(info));
    std::string all;
    for (const auto& candidate : cell.candidates)
        all += fmt::format("{} {} {}\n", candidate.algorithm->name(), candidate.preset,
                           candidate.settings.texts());
    const bool deformable =
        std::ranges::any_of(scene.bodies, [](const auto& body) { return body.deformable; });
    return {{"devices", devices},
            {"bodies", power_of_4(scene.bodies.size())},
            {"tetrahedra", power_of_4(tetrahedron_count(scene))},
            {"candidate_pairs", power_of_4(pairs)},
            {"deformable", deformable},
            {"candidates", hex(digest_of(all))}};
}

void choose(Cell& cell, const Scene& scene, const FrameRange& range, const ChoosingOptions& options) {
    if (cell.candidates.empty()) return;
    auto* team = cell.team;
    const auto undecided = cell; // a copy, because sessions refer to its candidates
    const auto& all = undecided.candidates;
    if (team != nullptr) team->check_same(question_of(undecided, scene, 0)["candidates"].dump());
    const auto frames = std::min(range.size(), most_choosing_frames);
    options.progress(fmt::format("auto: {} candidates", all.size()));
    for (auto* device : cell.devices) device->set_clocks(Clocks::off);
    std::vector<std::unique_ptr<Session>> sessions(all.size());
    Race race(
        all, {.prepare =
                  [&](std::size_t i) {
                      if (!sessions[i]) sessions[i] = prepare_session(all[i], scene);
                  },
              .replay = [&](std::size_t i) { return replayed(all[i], *sessions[i], range, frames, options); },
              .free = [&](std::size_t i) { sessions[i].reset(); },
              .decided = [&](double own) { return decided(team, own); },
              .progress =
                  [&](std::size_t i) {
                      options.progress(
                          fmt::format("auto: candidate {} of {}: {}", i + 1, all.size(), describe(all[i])));
                  }});
    const ChoiceFile file(is_first(team) ? options.folder : std::filesystem::path(),
                          question_of(undecided, scene, race.pairs() / frames));
    std::string warning;
    auto kept = options.afresh ? Json() : file.find(warning);
    if (team != nullptr) kept = Json::parse(team->decided(kept.dump()));
    if (!kept.is_null()) kept["from_cache"] = true;
    if (kept.is_null() || !settle(cell, kept)) {
        if (const auto ranking = race.run(options.seconds); !ranking.empty()) {
            settle(cell, choice_json(race, ranking, scene.key, range.first(), frames));
        }
    }
    options.progress("");
    warn(warning);
    if (!cell.chosen) return;
    if (!(*cell.chosen)["from_cache"].get<bool>()) warn(file.keep(*cell.chosen));
    print_choice(cell, options.seconds, file.path());
}

} // namespace tandem
