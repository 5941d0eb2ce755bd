// SPDX-License-Identifier: MIT
// tandem accuracy: error and speed over the settings that affect either.
#include "harness/commands/accuracy.h"
#include "harness/record/answer.h"
#include "harness/measuring/measure.h"
#include "harness/commands/accuracy_figures.h"
#include "harness/verify/adversarial.h"
#include "harness/program/interrupt.h"
#include "harness/program/cache_folder.h"
#include "harness/plans/cell_filter.h"
#include "harness/plans/inputs.h"
#include "harness/plans/task.h"
#include "base/standard_streams.h"
#include "base/statistics.h"
#include "base/error.h"
#include "scenes/hard/hard.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>
#include <optional>
#include <set>

namespace tandem {

namespace {

using Axis = std::pair<std::string, std::vector<std::string>>;

constexpr std::size_t default_frames = 10;

/// The values of a setting, without `excluded`; empty when the algorithm does not have the setting.
std::vector<std::string> choices(const Traversal& traversal, const std::string& name,
                                 const std::string& excluded = "") {
    std::vector<std::string> result;
    for (const auto* parameter : traversal.parameters())
        if (parameter->name == name)
            for (const auto& word : parameter->choices()) result.emplace_back(word.text);
    std::erase(result, excluded);
    return result;
}

/// Settings that affect bounds: directions, precision, rounding.
std::vector<Axis> axes_of_bounds(const Traversal& traversal) {
    return {{"k", {"6", "8", "14", "18", "26"}},
            {"precision", choices(traversal, "precision")},
            {"rounding", choices(traversal, "rounding")}};
}

/// Settings that affect contacts: precision, decision, rule, without rules that need a pressure field.
std::vector<Axis> axes_of_contacts(const Traversal& traversal) {
    auto rules = choices(traversal, "contact_rule", "none");
    for (const auto& word : parameters::contact_rule.choices())
        if (needs_pressures(static_cast<ContactRule>(word.value))) std::erase(rules, word.text);
    return {{"precision", choices(traversal, "precision")},
            {"decision", choices(traversal, "decision", "usual")}, // one of the others
            {"contact_rule", std::move(rules)}};
}

/// The default settings are in both sweeps; such a cell is measured once.
bool same(const Cell& a, const Cell& b) {
    return a.algorithm == b.algorithm && a.preset == b.preset && a.settings == b.settings
           && a.devices == b.devices;
}

/// The cells of a request without settings. Each algorithm and device has the sweep over bounds, then the one
/// over contacts, without combinations that a device or another setting excludes.
std::vector<Cell> sweep(const Request& request, std::span<const DeviceGroup> devices) {
    std::vector<Cell> cells;
    for (const auto& base : plan(request, devices)) {
        auto own = request;
        own.algorithms = {std::string(base.algorithm->name())};
        own.presets = {base.preset};
        for (const auto& axes : {axes_of_bounds(*base.algorithm), axes_of_contacts(*base.algorithm)}) {
            own.sets = axes;
            for (const auto& cell : plan(own, std::array{base.devices}, leave_out))
                if (std::none_of(cells.begin(), cells.end(), [&](const auto& c) { return same(c, cell); }))
                    cells.push_back(cell);
        }
    }
    return cells;
}

/// "FIRST:LAST" of the ten middle frames; empty for a scene with ten frames or fewer.
std::string middle_frames(const Scene& scene) {
    if (scene.frame_count <= default_frames) return "";
    const auto first = (scene.frame_count - default_frames) / 2;
    return fmt::format("{}:{}", first, first + default_frames - 1);
}

/// The difficulties of the family, ascending. A family of whole scenes has only the initial one, because its
/// scenes grow with the difficulty.
std::vector<double> difficulties(const HardFamily& family) {
    if (family.scene != nullptr) return {family.knob.initial};
    const auto all = difficulties_of(family);
    const std::set<double> sorted(all.begin(), all.end());
    return {sorted.begin(), sorted.end()};
}

/// Replaces hard:all by all families at several difficulties. Leaves out not-finite unless `handling` skips
/// such tetrahedra. Returns other scenes unchanged.
std::vector<std::string> expand(const std::string& scene, Degenerate handling) {
    const auto families = expand_hard(scene);
    if (families.size() < 2) return {scene};
    std::vector<std::string> scenes;
    for (const auto& one : families) {
        const auto name = one.substr(5, one.find(':', 5) - 5); // hard:NAME or hard:NAME:...
        if (name == "not-finite" && handling != Degenerate::skip) continue;
        for (const double difficulty : difficulties(hard_family(name)))
            scenes.push_back(fmt::format("{}{}difficulty={}", one,
                                         one.find(':', 5) == std::string::npos ? ":" : ",", difficulty));
    }
    return scenes;
}

/// Median time of a frame over the samples, in ms.
double frame_ms(const Measurement& m) {
    return median_ns(m) * 1e-6 / static_cast<double>(m.candidate_pairs.size());
}

std::string number(const std::optional<double>& value) { return value ? fmt::format("{:.3g}", *value) : "-"; }

std::string p99(const std::vector<double>& samples) {
    const auto s = spread(samples);
    return s ? fmt::format("{:.3g}", s->p99) : "-";
}

void print_header() {
    put("{:>9} {:>9} {:>9} {:>10} {:>10} {:>9} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9}  cell\n", "ms/frame",
        "missed", "lost", "false", "ratio", "no answer", "depth/uL", "degrees", "point/L", "volume",
        "dist/uL", "area/uL2");
}

/// Errors of contacts are 99th percentiles.
void print_row(const Cell& cell, const Measurement& m) {
    const auto& e = *m.errors;
    const auto contacts = e.contacts.value_or(ContactErrors{});
    put("{:>9.3g} {:>9} {:>9} {:>10} {:>10} {:>9} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9}  {}{}\n", frame_ms(m),
        e.missed(), e.rounding ? fmt::to_string(e.rounding->lost) : "-", e.pairs.disjoint,
        number(e.candidate_ratio()), contacts.unanswered, p99(contacts.depth_ulps),
        p99(contacts.normal_degrees), p99(contacts.point), p99(contacts.volume_relative),
        p99(contacts.distance_ulps), p99(contacts.polygon_ulps), describe(cell),
        e.missed() > 0 ? "  MISSES" : "");
}

/// Measures all cells on one scene, until a record cannot be written or an interrupt. Returns the exit code.
/// `scenes_after`: number of scenes that follow, for the estimate of the time left.
int measure_scene(const RunOptions& options, const std::vector<Cell>& cells, RecordFile& file,
                  std::size_t scenes_after) {
    auto own = options;
    auto scene = open_scene(own);
    if (own.frames.empty()) own.frames = middle_frames(scene);
    const Task task(std::move(scene), own, cells);
    print_scene(task);
    const auto cache = checks_folder(options);
    References references(task.scene, task.range, cache);
    Truths truths(task.scene, task.range, TruthAmount::contacts, options.truth_contacts, cache);
    const Progress progress(options.quiet);
    Measuring measuring;
    measuring.check = {options.check, false, &truths};
    measuring.stopping.repeat = options.repeat.value_or(3);
    measuring.stop = Interrupt::asked;
    int code = 0;
    print_header();
    const auto ended = [&](const CellResult& result) {
        const auto& m = result.measurement;
        code = std::max({code, result.code, misses_against_its_promise(m) ? 1 : 0});
        if (result.measured && !m.agreement.ok())
            put("WRONG against the reference: {}\n", describe(*result.cell));
        if (result.measured && m.errors) print_row(*result.cell, m);
    };
    // Measure cell by cell, not in rounds: rows appear early, and times are not compared between cells.
    auto later = task.cells.size() * (1 + scenes_after);
    for (const auto& cell : task.cells)
        measure_cells(task, {&cell, 1}, references, measuring, file, {progress, ended, --later});
    put("\n");
    return Interrupt::asked() && !file.failed() ? Interrupt::exit_code() : code;
}

void check_outputs(std::span<const Cell> cells) {
    for (const auto& cell : cells)
        if (leaves_out_pairs(cell.settings[parameters::output]))
            throw InputError(
                fmt::format("accuracy needs all candidate pairs, and output={} may leave some out; set "
                            "output=pairs",
                            cell.settings.text("output")));
}

} // namespace

int accuracy_command(const AccuracyOptions& options) {
    auto request = options.run.request;
    if (request.devices.empty()) request.devices.emplace_back(default_device);
    if (request.algorithms.empty()) request.algorithms.emplace_back(algorithms().front()->name());
    const auto backends = open_named(request.devices, options.run.require);
    const auto devices = open_devices(options.run, backends, request.devices);
    auto cells = request.sets.empty() ? sweep(request, devices) : plan(request, devices);
    keep_matching(cells, options.run.filter);
    check_outputs(cells);
    auto scenes = options.scenes;
    // An empty name stands for --mesh; without meshes it causes the error message.
    if (scenes.empty()) scenes.emplace_back();
    std::optional<Figures> figures;
    if (!options.figures.empty()) figures.emplace(options.figures);
    const auto records =
        figures && options.run.out.empty() ? options.figures + "/accuracy.jsonl" : options.run.out;
    RecordFile file(records);
    report_cache_folder();
    std::optional<Interrupt> interrupt(std::in_place, Interrupt::stopping);
    int code = 0;
    std::vector<std::string> expanded;
    for (const auto& given : scenes)
        for (auto& scene : expand(given, options.run.degenerate)) expanded.push_back(std::move(scene));
    auto scenes_after = expanded.size();
    for (const auto& scene : expanded) {
        auto own = options.run;
        own.scene = scene;
        code = std::max(code, measure_scene(own, cells, file, --scenes_after));
        if (file.failed() || Interrupt::asked()) return code;
    }
    put("ms/frame: the whole frame; lost: by the rounding of vertices, of pairs that intersect by the "
        "input;\n"
        "ratio: candidates per intersecting pair; errors of contacts are 99th percentiles;\n"
        "u: half a unit in the last place of 1; L: the longest edge; volume: relative error of the volume of "
        "the contact\n"
        "points' hull; MISSES: intersecting pairs are missing from the candidates\n");
    interrupt.reset(); // the program that draws has its own
    if (figures) figures->draw(records);
    return code;
}

} // namespace tandem
