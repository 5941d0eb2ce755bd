// SPDX-License-Identifier: MIT
#include "harness/plans/cache_folder.h"
#include "harness/plans/job.h"

#include "algorithms/bodies/nothing_meets.h"
#include "algorithms/bounds/geometry.h"
#include "algorithms/parameters/table.h"
#include "harness/plans/inputs.h"
#include "harness/sampling/isolation/isolated_sampler.h"
#include "harness/plans/key.h"
#include "harness/sampling/ranks/rank_team.h"
#include "harness/record/record.h"
#include "harness/sampling/local_sampler.h"
#include "base/standard_streams.h"
#include "base/text_lines.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace tandem {

namespace {

/// Removes cells whose precision cannot represent the coordinates of a frame. Each precision is checked once.
void fit_coordinates(Job& job, const Unfit& unfit) {
    std::map<Precision, std::optional<InputError>> known;
    std::erase_if(job.cells, [&](const Cell& cell) {
        const auto [found, is_new] = known.try_emplace(geometry_of(cell.settings).precision);
        if (is_new) try {
                check_coordinates(cell, job.scene, job.range);
            } catch (const InputError& error) {
                found->second = error;
            }
        if (found->second) unfit(*found->second);
        return found->second.has_value();
    });
}

} // namespace

Job open_job(const RunOptions& options, std::vector<Cell> cells, const Unfit& unfit) {
    return Job(open_scene(options), options, std::move(cells), unfit);
}

Job::Job(Scene opened, const RunOptions& given, std::vector<Cell> planned, const Unfit& unfit)
    : options(given),
      scene(std::move(opened)),
      range(open_frames(options, scene, bounds_motion(planned))),
      cells(std::move(planned)) {
    check_outputs(options, cells);
    fit_coordinates(*this, unfit);
}

namespace {

/// Writes results: records to a file, and the rounds of unfinished cells to the file beside it.
class ResultSink {
public:
    ResultSink(RecordFile& file, Unfinished* unfinished) : file_(file), unfinished_(unfinished) {}

    /// The earlier state of a cell, by the key of the requested settings.
    CellState state(const Cell& cell, const std::string& key) {
        return unfinished_ == nullptr ? CellState() : unfinished_->state(cell, key);
    }
    /// Stores a cell that needs more rounds: its whole state, or its last round.
    void keep(const CellSampler& sampler, const std::string& key, bool whole) {
        if (unfinished_ != nullptr) unfinished_->keep(key, sampler.state(), whole);
    }
    /// Appends a record and prints the failure of its cell, if any. Returns false when it could not be
    /// written.
    bool end(const CellResult& result, const nlohmann::ordered_json& record, const std::string& failure) {
        const bool recorded = file_.append_or_report(record);
        if (!failure.empty()) print_message("tandem: {}: {}\n", describe(*result.cell), failure);
        return recorded;
    }
    bool failed() const { return file_.failed(); }

private:
    RecordFile& file_;
    Unfinished* unfinished_;
};

/// Ends a cell. A failed device affects only its own cell: the record names the failure, and other cells
/// continue.
CellResult end_cell(const Outcome& outcome, const Sampling& sampling, const Job& job, ResultSink& sink) {
    CellResult result;
    result.cell = &outcome.sampler->cell();
    result.measurement = outcome.sampler->measurement();
    result.measured = outcome.failure.empty();
    result.converged = outcome.converged;
    const bool recorded =
        !is_first(result.cell->team)
        || sink.end(result,
                    make_record(*result.cell, job.scene, job.range, result.measurement, outcome, sampling),
                    outcome.failure);
    if (!result.measured || !recorded)
        result.code = 3;
    else
        result.code = result.measurement.agreement.ok() ? 0 : 1;
    return result;
}

std::string requested_key(const Cell& cell, const Job& job) {
    return key_of(cell, cell.settings, job.scene, job.range);
}

/// The state of a cell that an earlier run began. Collective: all ranks get the state of rank 0.
CellState shared_state(const Cell& cell, CellState own) {
    if (cell.team == nullptr || !cell.team->decided(own.is_checked())) return own;
    const auto text = cell.team->decided(
        nlohmann::json{{"checked", checked_json(own)}, {"rounds", rounds_json(own, 0)}}.dump());
    if (cell.team->is_first()) return own;
    const auto json = nlohmann::json::parse(text);
    CellState state;
    take_checked(state, json.at("checked"), cell);
    take_rounds(state, json.at("rounds"));
    return state;
}

std::unique_ptr<CellSampler> make_sampler(const Cell& cell, const Job& job, References& references,
                                          ResultSink& sink) {
    auto state = shared_state(cell, sink.state(cell, requested_key(cell, job)));
    if (job.options.isolate) return std::make_unique<IsolatedSampler>(cell, job.options, std::move(state));
    return std::make_unique<LocalSampler>(cell, job.scene, job.range, references, std::move(state));
}

} // namespace

bool measure_cells(const Job& job, std::span<const Cell> cells, References& references,
                   const Measuring& measuring, RecordFile& file, const CellsListener& listener) {
    ResultSink sink(file, measuring.unfinished);
    std::vector<std::unique_ptr<CellSampler>> samplers;
    std::vector<CellSampler*> group;
    for (const auto& cell : cells)
        group.push_back(samplers.emplace_back(make_sampler(cell, job, references, sink)).get());
    RoundsListener rounds;
    std::size_t done = 0;
    rounds.later_cells = listener.later_cells;
    rounds.progress = [&](std::string_view text, std::optional<double> left) {
        listener.progress.show(fmt::format("{}/{} {}", done, cells.size(), text), left);
    };
    rounds.before_round = measuring.before_round;
    rounds.stop = [&] { return sink.failed() || measuring.stop(); };
    rounds.kept = [&](const CellSampler& sampler, bool is_first) {
        sink.keep(sampler, requested_key(sampler.cell(), job), is_first);
    };
    rounds.finished = [&](const Outcome& outcome, const Sampling& sampling) {
        ++done;
        listener.progress.clear();
        listener.ended(end_cell(outcome, sampling, job, sink));
    };
    return sample_group(group, measuring.check, measuring.stopping, measuring.seed, rounds);
}

std::filesystem::path checks_folder(const RunOptions& options) {
    return options.check_afresh ? std::filesystem::path() : cache_folder();
}

std::string scene_text(const Scene& scene, const FrameRange& range) {
    auto text = fmt::format("scene {}: {} bodies, {} vertices, {} tetrahedra, frames {}:{}, digest {:016x}\n",
                            visible(scene.key), scene.bodies.size(), vertex_count(scene),
                            tetrahedron_count(scene), range.first(), range.last(), scene.digest);
    std::size_t inverted = 0;
    for (const auto& mesh : scene.meshes) inverted += mesh.inverted;
    if (inverted > 0)
        text += fmt::format("its meshes have {} inverted tetrahedra; they are kept\n", inverted);
    if (range.flaws().any())
        text += fmt::format("tetrahedra {}; they {}\n", visible(describe(range.flaws(), scene)),
                            range.flaws().handling == Degenerate::skip ? "take no part"
                                                                       : "take part as flat sets");
    if (range.has_successor())
        text += fmt::format("motion=linear: frame {} is only the successor of frame {}\n", range.last() + 1,
                            range.last());
    return text;
}

void print_scene(const Job& job) {
    put_text(scene_text(job.scene, job.range));
    report_findings(job.scene);
    std::set<std::string> reasons;
    for (const auto& cell : job.cells)
        reasons.insert(why_nothing_meets(job.scene, cell.settings[parameters::self]));
    reasons.erase(std::string());
    for (const auto& reason : reasons)
        print_message("tandem: scene {}: nothing can meet: {}\n", visible(job.scene.name), reason);
    const auto far = std::ranges::count_if(job.cells, [](const Cell& cell) {
        return cell.candidates.empty() && cell.settings[parameters::origin] == Origin::automatic
               && geometry_of(cell.settings).origin == Origin::world;
    });
    if (far > 0 && job.range.origin(Origin::automatic) != Eigen::Vector3d::Zero())
        print_message(
            "tandem: {} cell{} with placement=exact and precision=double: coordinates count from the world's "
            "origin, which is far from the scene; choose precision=float, or move the scene\n",
            far, far == 1 ? "" : "s");
}

bool misses_against_its_promise(const Measurement& m) {
    const auto rounding = m.settings[parameters::rounding];
    return m.errors && m.errors->missed() > 0
           && (rounding == Rounding::safe || rounding == Rounding::directed);
}

} // namespace tandem
