// SPDX-License-Identifier: MIT
#include "harness/commands.h"
#include "harness/device_groups.h"
#include "harness/interrupt.h"
#include "harness/paper/drawing.h"
#include "harness/paper/paper_folder.h"
#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <fmt/format.h>
#include <optional>

namespace tandem {

namespace {

/// Throws InputError where there is no such device.
PaperPlace place_of(const std::string& device) {
    const auto backends = open_backends(std::array{device}, {});
    const auto group = choose_devices(backends, std::array{device});
    if (group.size() != 1 || group.front().size() != 1)
        throw InputError(fmt::format("--device {}: the paper's scenes are on one device; name it", device));
    const auto& info = group.front().front()->info();
    return {device, std::min(info.global_bytes / 4, info.max_allocation)};
}

/// "40 s", "7 min".
std::string told(double seconds) {
    return seconds < 90 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
}

/// "N" or "FIRST:LAST" of the steps, from 1. Throws InputError.
std::pair<std::size_t, std::size_t> named_steps(const std::string& text, std::size_t count) {
    if (text.empty()) return {1, count};
    const auto colon = std::min(text.find(':'), text.size());
    std::size_t first = 0, last = 0;
    const auto number = [](std::string_view part, std::size_t& value) {
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
        return error == std::errc() && end == part.data() + part.size();
    };
    const std::string_view all = text;
    const bool good =
        number(all.substr(0, colon), first) && number(all.substr(colon == all.size() ? 0 : colon + 1), last);
    if (!good || first < 1 || last > count || first > last)
        throw InputError(fmt::format("--steps {}: give N or FIRST:LAST of 1:{}", text, count));
    return {first, last};
}

void list_steps(const PaperFolder& folder, std::span<const PaperStep> steps) {
    double left = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const bool done = folder.is_done(steps[i]);
        if (!done) left += steps[i].seconds;
        put("{:>3}  {:<18} {:>6}  {}\n", i + 1, steps[i].name, done ? "done" : told(steps[i].seconds),
            steps[i].says);
    }
    put("about {} left, as long as it took where the committed results were measured\n", told(left));
}

/// How long the rest is likely to take: what it took elsewhere, by how much slower or faster this machine has
/// been so far.
class Estimate {
public:
    explicit Estimate(double expected) : left_(expected) {}
    void took(const PaperStep& step, double seconds) {
        left_ -= step.seconds;
        expected_ += step.seconds;
        real_ += seconds;
    }
    double of(double seconds) const { return expected_ > 0 ? seconds * real_ / expected_ : seconds; }
    double left() const { return of(left_); }

private:
    double left_, expected_ = 0, real_ = 0;
};

/// Does what is left of the steps; the worst exit code. One that fails stops none that follows.
int run_steps(PaperFolder& folder, std::span<const PaperStep> steps, std::size_t first, std::size_t last) {
    double expected = 0;
    for (auto i = first; i <= last; ++i)
        if (!folder.is_done(steps[i - 1])) expected += steps[i - 1].seconds;
    Estimate estimate(expected);
    const Interrupt interrupt;
    int worst = 0;
    for (auto i = first; i <= last && !Interrupt::asked(); ++i) {
        const auto& step = steps[i - 1];
        if (folder.is_done(step)) continue;
        tell("{}/{} {}: {} (about {}; all about {})\n", i, steps.size(), step.name, step.says,
             told(estimate.of(step.seconds)), told(estimate.left()));
        const auto begin = std::chrono::steady_clock::now();
        const int code = folder.run(step);
        estimate.took(step, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        if (code == 0 || Interrupt::asked()) continue;
        tell("tandem: step {} ended with {}: {}; its output is in {}/logs\n", step.name, code,
             folder.last_line(step), folder.path());
        worst = std::max(worst, code == 1 ? 1 : 3);
    }
    if (Interrupt::asked()) tell("tandem: interrupted; the same command goes on\n");
    return Interrupt::asked() ? std::max(worst, 3) : worst;
}

} // namespace

int paper_command(const PaperOptions& options) {
    if (options.folder.empty()) throw InputError("no folder for tables and figures; give -o FOLDER");
    if (options.draw_only) return PaperDrawing().draw(options.folder) ? 0 : 3;
    const auto steps = paper_steps(options.size, place_of(options.device));
    const auto [first, last] = named_steps(options.steps, steps.size());
    PaperFolder folder(options.folder, options.size, options.device);
    if (options.dry_run) {
        list_steps(folder, steps);
        return 0;
    }
    std::optional<PaperDrawing> drawing;
    if (!options.measure_only) drawing.emplace(); // before anything is measured: it may lack something
    if (options.again)
        for (auto i = first; i <= last; ++i) folder.forget(steps[i - 1]);
    const int worst = run_steps(folder, steps, first, last);
    return !drawing || drawing->draw(options.folder) ? worst : 3;
}

} // namespace tandem
