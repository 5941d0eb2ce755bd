// SPDX-License-Identifier: MIT
// tandem check: compares every algorithm on every device with the reference, and counts the pairs of the
// exact truth that it misses.
#include "base/counted.h"
#include "harness/commands/check.h"
#include "harness/measuring/measure.h"
#include "harness/program/interrupt.h"
#include "harness/program/cache_folder.h"
#include "harness/plans/cell_filter.h"
#include "harness/plans/inputs.h"
#include "harness/plans/task.h"
#include "harness/record/answer.h"
#include "base/standard_streams.h"
#include "base/error.h"
#include "scenes/hard/hard.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <numeric>

namespace tandem {

namespace {

/// Checks every cell and calls `print` for each that finished. Stops when a record cannot be written. Returns
/// the exit code, also after an interrupt.
int check_cells(const Task& task, const RunOptions& options, RecordFile& file, const Progress& progress,
                const std::function<void(const Cell&, const Measurement&)>& print) {
    References references(task.scene, task.range);
    Truths truths(task.scene, task.range, options.truth, options.truth_contacts);
    Measuring measuring;
    measuring.check.truths = options.truth == TruthAmount::none ? nullptr : &truths;
    measuring.stopping.repeat = 0;
    measuring.stop = Interrupt::asked;
    int code = 0;
    const auto ended = [&](const CellResult& result) {
        const auto& m = result.measurement;
        code = std::max({code, result.code, misses_against_its_promise(m) ? 1 : 0});
        if (result.measured) print(*result.cell, m);
    };
    const bool interrupted = measure_cells(task, task.cells, references, measuring, file, {progress, ended});
    return interrupted && !file.failed() ? Interrupt::exit_code() : code;
}

/// One line for each cell: its answer compared with the reference, then with the truth.
void print_matrix_header() {
    put("{:<10} {:<12} {:<18} {:>10} {:>9} {:>8} {:>6} {:>9} {:<14} {:>8} {:>10} {:>8}\n", "device",
        "algorithm", "preset", "pairs", "missing", "extra", "retry", "contacts", "contacts equal", "missed",
        "false", "lost");
}

/// Pairs that meet by the input and that rounding lost.
std::string lost_text(const Measurement& m) {
    return m.errors && m.errors->rounding ? fmt::to_string(m.errors->rounding->lost) : "-";
}

void print_matrix_row(const Cell& cell, const Measurement& m) {
    put("{:<10} {:<12} {:<18} {:>10} {:>9} {:>8} {:>6} {:>9} {:<14} {:>8} {:>10} {:>8}\n",
        name_of(cell.devices), cell.algorithm->name(), cell.preset, m.agreement.digest.count,
        m.agreement.missing, m.agreement.extra, m.counts.retries,
        std::accumulate(m.contacts.begin(), m.contacts.end(), std::uint64_t{0}),
        m.agreement.contact_frames_wrong == 0 ? "yes" : "NO",
        m.errors ? fmt::to_string(m.errors->missed()) : "-",
        m.errors ? fmt::to_string(m.errors->pairs.disjoint) : "-", lost_text(m));
}

void print_family_header() {
    put("{:<26} {:>6} {:>9} {:>11} {:>12} {:>13} {:>6} {:>6} {:>6}\n", "family", "frames", "touching",
        "overlapping", "missed: safe", "missed: other", "lost", "cells", "wrong");
}

/// Checks one family of hard:all and prints one line. Pairs that cells miss are counted apart for
/// rounding=safe and for the other roundings.
int check_family(const Task& task, const RunOptions& options, RecordFile& file, const Progress& progress) {
    std::uint64_t wrong = 0;
    std::uint64_t missed_safe = 0;
    std::uint64_t missed_other = 0;
    std::uint64_t lost = 0; // the most of a cell
    PairErrors errors;
    const int code = check_cells(task, options, file, progress, [&](const Cell&, const Measurement& m) {
        wrong += m.agreement.ok() ? 0 : 1;
        if (!m.errors) return;
        errors = m.errors->pairs;
        (m.settings[parameters::rounding] == Rounding::safe ? missed_safe : missed_other) +=
            m.errors->missed();
        if (m.errors->rounding) lost = std::max(lost, m.errors->rounding->lost);
    });
    if (Interrupt::asked()) return code;
    const auto& flaws = task.range.flaws();
    put("{:<26} {:>6} {:>9} {:>11} {:>12} {:>13} {:>6} {:>6} {:>6}{}\n", task.scene.name, task.range.size(),
        errors.touching + errors.missed_touching, errors.overlapping + errors.missed_overlapping, missed_safe,
        missed_other, lost, task.cells.size(), wrong,
        flaws.any() && flaws.handling == Degenerate::skip
            ? fmt::format("  skipped: {}", flaws.degenerate + flaws.non_finite)
            : "");
    return code;
}

/// The family with non-finite coordinates must be refused unless they are skipped. Returns 1 when it is not.
int check_refusal(RunOptions options, const std::vector<Cell>& cells) {
    options.degenerate = Degenerate::flat;
    std::string refusal;
    try {
        open_task(options, cells);
    } catch (const InputError& error) {
        refusal = error.what();
        if (refusal.find("not finite") == std::string::npos) throw; // refused for another reason
    }
    put("{:<26} {}\n", "hard:not-finite", refusal.empty() ? "NOT refused" : "refused: " + refusal);
    return refusal.empty() ? 1 : 0;
}

/// `tandem check hard:all`. The family with non-finite coordinates must be refused, and must be right when
/// its flawed tetrahedra are skipped.
int check_hard(const RunOptions& options, const std::vector<Cell>& cells,
               const std::vector<std::string>& scenes) {
    RecordFile file(options.out);
    const Progress progress(options.quiet);
    print_family_header();
    int code = 0;
    for (const auto& scene : scenes) {
        auto one = options;
        one.scene = scene;
        if (scene.starts_with("hard:not-finite")) {
            code = std::max(code, check_refusal(one, cells));
            one.degenerate = Degenerate::skip;
        }
        code = std::max(code, check_family(open_task(one, cells), one, file, progress));
        if (file.failed() || Interrupt::asked()) return code;
    }
    put("{}\n", code == 0
                    ? "all agree with the reference; rounding=safe misses no pair that touches or overlaps"
                    : "NOT all agree with the reference and the truth");
    return code;
}

/// Shortens the queues of arrays that are larger than the default, unless the request names a size. Answers
/// do not depend on it, and uploads of gigabytes a batch would take most of a check. Queues of 4096 items are
/// longer than what ends a launch on any device: two groups of 1024 and a local queue of 2048.
std::vector<Cell> with_small_queues(std::vector<Cell> cells, const Request& request) {
    constexpr std::string_view name = "queue_bytes", shorter = "queue_capacity";
    if (std::ranges::any_of(request.sets,
                            [&](const auto& set) { return set.first == name || set.first == shorter; }))
        return cells;
    for (auto& cell : cells) {
        const auto named = [&](std::string_view wanted) {
            const auto all = cell.algorithm->parameters();
            const auto found = std::ranges::find(all, wanted, &Parameter::name);
            return found == all.end() ? nullptr : *found;
        };
        const auto* array = named(name);
        if (array == nullptr) continue;
        const auto bytes = array->parse(cell.settings.text(name));
        const bool is_of_device = bytes < array->least;
        if (is_of_device || bytes > array->initial) cell.settings.set({named(shorter), 4096});
    }
    return cells;
}

/// Throws InputError for a value that its setting cannot have in any cell.
void check_values(const Request& request) {
    for (const auto& [name, values] : request.sets)
        for (const auto* traversal : algorithms())
            for (const auto* parameter : traversal->parameters())
                if (parameter->name == name)
                    for (const auto& value : values) parameter->parse(value);
}

/// The cells of a check. A request without presets asks for all of them: those that its settings do not suit
/// are left out, with a line for each reason, unless none is left.
std::vector<Cell> plan_check(Request request, std::span<const DeviceGroup> devices) {
    if (!request.presets.empty()) return with_small_queues(plan(request, devices), request);
    check_values(request);
    request.presets.emplace_back("all");
    std::vector<std::string> reasons;
    std::size_t left_out = 0;
    auto cells = plan(request, devices, [&](const InputError& error) {
        ++left_out;
        if (std::ranges::find(reasons, error.what()) == reasons.end()) reasons.emplace_back(error.what());
    });
    if (cells.empty() && left_out > 0) throw InputError(reasons.front());
    if (left_out > 0)
        print_message("tandem: {} of {} left out: {}\n", left_out, counted(left_out + cells.size(), "cell"),
                      fmt::join(reasons, "; "));
    return with_small_queues(std::move(cells), request);
}

std::vector<Cell> filtered(std::vector<Cell> cells, const RunOptions& options) {
    keep_matching(cells, options.filter);
    return cells;
}

} // namespace

int check_command(const RunOptions& options) {
    auto request = options.request;
    if (request.devices.empty()) request.devices.emplace_back("all");
    const auto backends = open_named(request.devices, options.require);
    const auto devices = open_devices(options, backends, request.devices);
    report_cache_folder();
    const auto scenes = expand_hard(options.scene);
    const Interrupt interrupt(Interrupt::stopping);
    if (scenes.size() > 1)
        return check_hard(options, filtered(with_small_queues(plan(request, devices), request), options),
                          scenes);
    const auto task = open_task(options, filtered(plan_check(request, devices), options));
    RecordFile file(options.out);
    print_scene(task);
    const Progress progress(options.quiet);
    std::size_t broken = 0;
    std::map<std::string, std::size_t> roundings; // cells by what rounding changed
    print_matrix_header();
    const int code = check_cells(task, options, file, progress, [&](const Cell& cell, const Measurement& m) {
        print_matrix_row(cell, m);
        broken += misses_against_its_promise(m) ? 1 : 0;
        if (m.errors && m.errors->rounding) ++roundings[rounding_text(*m.errors->rounding)];
    });
    if (file.failed() || Interrupt::asked()) return code;
    put("{}\n", code == 0 ? "all agree with the reference" : "NOT all agree with the reference");
    for (const auto& [text, cells] : roundings) put("{}: {}\n", counted(cells, "cell"), text);
    if (broken > 0) put("{} with safe rounding MISS pairs that touch or overlap\n", counted(broken, "cell"));
    return code;
}

} // namespace tandem
