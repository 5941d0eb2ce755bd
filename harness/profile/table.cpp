// SPDX-License-Identifier: MIT
#include "harness/profile/output.h"
#include "base/columns.h"
#include "base/standard_streams.h"
#include "base/text_lines.h"

#include <algorithm>
#include <fmt/format.h>
#include <functional>

namespace tandem::profile {

namespace {

constexpr double least_fraction = 0.01; ///< least fraction of the device time for a separate row
constexpr const char* unknown = "-";

using Text = std::function<std::string(const KernelProfile&)>;

/// At least three significant digits, without an exponent for large values.
std::string digits(double value) {
    if (value >= 1000) return fmt::format("{:.0f}", value);
    return value >= 100 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

Text scaled(std::optional<double> (KernelProfile::*of)() const, double scale) {
    return [=](const KernelProfile& kernel) -> std::string {
        const auto value = (kernel.*of)();
        return value ? digits(*value * scale) : unknown;
    };
}

Text percent(std::optional<double> (KernelProfile::*of)() const) {
    return [=](const KernelProfile& kernel) -> std::string {
        const auto value = (kernel.*of)();
        return value ? fmt::format("{:.1f} %", *value * 100) : unknown;
    };
}

Text fact(std::int64_t KernelFacts::*of) {
    return [=](const KernelProfile& kernel) -> std::string {
        const auto value = kernel.sample.facts.*of;
        return value < 0 ? unknown : std::to_string(value);
    };
}

std::string megabytes(const KernelProfile& kernel) {
    return kernel.bytes ? digits(*kernel.bytes * 1e-6) : unknown;
}

std::string millions(const KernelProfile& kernel) {
    return kernel.operations ? digits(*kernel.operations * 1e-6) : unknown;
}

std::string floor_us(const KernelProfile& kernel) {
    const auto ns = kernel.floor.ns();
    return ns ? digits(*ns * 1e-3) : unknown;
}

std::string occupancy(const KernelProfile& kernel) {
    const auto fraction = kernel.sample.facts.occupancy;
    return fraction < 0 ? unknown : fmt::format("{:.0f} %", fraction * 100);
}

std::string bound(const KernelProfile& kernel) {
    const auto limit = kernel.bound();
    return limit ? std::string(*limit) : unknown;
}

std::string half_width(const KernelProfile& kernel) {
    return "± " + digits((kernel.ns.high - kernel.ns.low) / 2 * 1e-3);
}

/// Heads and texts of the columns.
std::vector<std::pair<const char*, Text>> columns_of() {
    return {{"us/frame", [](const auto& k) { return digits(k.ns.median * 1e-3); }},
            {"95 %", half_width},
            {"share", [](const auto& k) { return fmt::format("{:.1f} %", k.time_fraction * 100); }},
            {"launches", [](const auto& k) { return digits(k.launches); }},
            {"floor us", floor_us},
            {"x floor", scaled(&KernelProfile::over_floor, 1)},
            {"bound", bound},
            {"MB", megabytes},
            {"GB/s", scaled(&KernelProfile::bytes_per_s, 1e-9)},
            {"of ceiling", percent(&KernelProfile::of_bytes)},
            {"Mop", millions},
            {"Gop/s", scaled(&KernelProfile::operations_per_s, 1e-9)},
            {"of ceiling", percent(&KernelProfile::of_operations)},
            {"groups", [](const auto& k) { return std::to_string(k.sample.groups); }},
            {"x", [](const auto& k) { return std::to_string(k.sample.group_size); }},
            {"registers", fact(&KernelFacts::registers)},
            {"local", fact(&KernelFacts::local_bytes)},
            {"spills", fact(&KernelFacts::spill_bytes)},
            {"stack", fact(&KernelFacts::stack_bytes)},
            {"occupancy", occupancy}};
}

/// The sum of the kernels that share one row.
KernelProfile sum_of(std::span<const KernelProfile> kernels) {
    KernelProfile sum;
    for (const auto& kernel : kernels) {
        sum.ns.median += kernel.ns.median;
        sum.ns.low += kernel.ns.low;
        sum.ns.high += kernel.ns.high;
        sum.time_fraction += kernel.time_fraction;
        sum.launches += kernel.launches;
    }
    return sum;
}

std::string ceilings_text(const Profile& profile) {
    const auto& l = profile.limits;
    return paragraph(
        fmt::format("ceilings, {}: {} GB/s, cache {} GB/s (to {} MB), {} G comparisons/s, launch {} us",
                    profile.ceilings_from, digits(l.bytes_per_s * 1e-9), digits(l.cached_bytes_per_s * 1e-9),
                    digits(l.cached_bytes * 1e-6), digits(l.operations_per_s * 1e-9),
                    digits(l.launch_s * 1e6)),
        2, output_columns());
}

} // namespace

std::string profile_legend() {
    return fmt::format(
        "floor: the largest of the times of bytes, comparisons and empty launches at the ceilings\n"
        "bytes (MB): each input read once, each output written once\n"
        "comparisons (Mop): of slab bounds, k in an overlap test\n"
        "bound: the largest term of the floor; latency when a kernel takes {} times the floor\n"
        "-: not declared, or unknown\n",
        latency_from);
}

std::string profile_table(const Profile& profile, bool all) {
    auto rows = profile.kernels;
    const auto small =
        std::ranges::find_if(rows, [&](const auto& k) { return !all && k.time_fraction < least_fraction; });
    const std::vector<KernelProfile> rest(small, rows.end());
    rows.erase(small, rows.end());
    const auto count = rows.size();
    if (!rest.empty()) rows.push_back(sum_of(rest));
    std::vector<std::string> labels;
    for (std::size_t i = 0; i < rows.size(); ++i)
        labels.push_back(i < count ? rows[i].entry : fmt::format("{} below 1 %", rest.size()));
    std::vector<TableColumn> columns;
    std::size_t before_rates = 4; // a sum has only the first four columns
    for (const auto& [head, text] : columns_of()) {
        TableColumn column{head, {}};
        for (std::size_t i = 0; i < rows.size(); ++i)
            column.texts.push_back(i < count || before_rates > 0 ? text(rows[i]) : "");
        before_rates -= before_rates > 0 ? 1 : 0;
        // Hides a column without values: the backend does not report them, or the only row is a sum.
        if (std::ranges::all_of(column.texts, [](const auto& t) { return t.empty() || t == unknown; }))
            column.texts.assign(rows.size(), "");
        columns.push_back(std::move(column));
    }
    return in_columns(labels, "kernels", columns) + "\n" + ceilings_text(profile);
}

} // namespace tandem::profile
