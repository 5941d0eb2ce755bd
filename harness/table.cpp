// SPDX-License-Identifier: MIT
#include "harness/table.h"

#include "harness/statistics.h"

#include <fmt/format.h>
#include <numeric>

namespace tandem {

namespace {

/// Over the frames of the breakdown run.
StageSample sum_of(const Measurement& m, Stage stage) {
    StageSample sum;
    for (const auto& frame : m.stages) sum += frame[static_cast<std::size_t>(stage)];
    return sum;
}

double device_ms(const Measurement& m, Stage stage) {
    return static_cast<double>(sum_of(m, stage).device_ns) * 1e-6;
}
double host_ms(const Measurement& m, Stage stage) {
    return static_cast<double>(sum_of(m, stage).host_ns) * 1e-6;
}

/// The device's when it finds the body pairs.
double broad_ms(const Measurement& m) {
    return sum_of(m, Stage::broad).launches > 0 ? device_ms(m, Stage::broad) : host_ms(m, Stage::broad);
}

/// One number over all frames and stages.
template<class Member>
std::uint64_t over_stages(const Measurement& m, Member member) {
    std::uint64_t sum = 0;
    for (const auto& frame : m.stages)
        for (const auto& sample : frame) sum += sample.*member;
    return sum;
}

/// The median sample; of a cell without samples (check, --repeat 0) the span of the breakdown run.
double total_ms(const Measurement& m) {
    std::vector<std::int64_t> sums;
    for (const auto& frames : m.total_ns)
        sums.push_back(std::accumulate(frames.begin(), frames.end(), std::int64_t{0}));
    if (sums.empty())
        sums.push_back(std::accumulate(m.breakdown_ns.begin(), m.breakdown_ns.end(), std::int64_t{0}));
    return summarise(sums).median * 1e-6;
}

/// Kernels of the walk and its contacts, without transform, refit and broad phase.
double kernels_ms(const Measurement& m) {
    double sum = 0;
    for (const auto stage : {Stage::seed, Stage::traverse, Stage::balance, Stage::contact})
        sum += device_ms(m, stage);
    return sum;
}

/// Kernels, transfers and conversions after the refit: what the paper calls the narrow phase, less its
/// wall-clock overheads.
double narrow_ms(const Measurement& m) {
    return kernels_ms(m) + device_ms(m, Stage::read) + device_ms(m, Stage::write)
           + host_ms(m, Stage::preprocess) + host_ms(m, Stage::postprocess);
}

std::uint64_t count_of(const std::vector<std::uint64_t>& values) {
    return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

/// describe() without the device, which has a column of its own.
std::string label(const Cell& cell) {
    const auto text = describe(cell);
    return text.substr(0, text.rfind(" on "));
}

std::string ratio(double above, double below) {
    return below > 0 ? fmt::format("{:>10.2f}", above / below) : fmt::format("{:>10}", "-");
}

} // namespace

std::string stage_table(std::span<const Row> rows) {
    std::size_t width = 10;
    for (const auto& row : rows) width = std::max(width, label(*row.cell).size());
    std::string text = fmt::format("{:<{}} {:<9} {:>9} {:>9} {:>8} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8} "
                                   "{:>8} {:>9} {:>6} {:>10} {:>9} {:>10}\n",
                                   "method", width, "device", "transform", "refit", "broad", "seed",
                                   "traverse", "balance", "contact", "preproc", "postproc", "read", "write",
                                   "launches", "waits", "pairs", "contacts", "total ms");
    for (const auto& [cell, m] : rows)
        text += fmt::format(
            "{:<{}} {:<9} {:>9.2f} {:>9.2f} {:>8.2f} {:>8.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} "
            "{:>8.2f} {:>8.2f} {:>9} {:>6} {:>10} {:>9} {:>10.2f}\n",
            label(*cell), width, name_of(cell->devices), device_ms(*m, Stage::transform),
            device_ms(*m, Stage::refit), broad_ms(*m), device_ms(*m, Stage::seed),
            device_ms(*m, Stage::traverse), device_ms(*m, Stage::balance), device_ms(*m, Stage::contact),
            host_ms(*m, Stage::preprocess), host_ms(*m, Stage::postprocess), device_ms(*m, Stage::read),
            device_ms(*m, Stage::write), over_stages(*m, &StageSample::launches),
            over_stages(*m, &StageSample::waits), count_of(m->candidate_pairs), count_of(m->contacts),
            total_ms(*m));
    return text;
}

std::string speedup_table(std::span<const Row> rows) {
    if (rows.empty()) return {};
    const auto base = rows.front().cell->algorithm->name();
    const auto launches = [](const Measurement& m) {
        return static_cast<double>(over_stages(m, &StageSample::launches));
    };
    std::string text;
    for (const auto& [g, gm] : rows) {
        if (g->algorithm->name() == base) continue;
        for (const auto& [c, cm] : rows) {
            if (c->algorithm->name() != base || c->devices != g->devices) continue;
            text +=
                fmt::format("{:<60} {:<9} {} {} {} {} {} {}\n", fmt::format("{} / {}", label(*g), label(*c)),
                            name_of(g->devices), ratio(total_ms(*gm), total_ms(*cm)),
                            ratio(narrow_ms(*gm), narrow_ms(*cm)), ratio(kernels_ms(*gm), kernels_ms(*cm)),
                            ratio(device_ms(*gm, Stage::read), device_ms(*cm, Stage::read)),
                            ratio(device_ms(*gm, Stage::write), device_ms(*cm, Stage::write)),
                            ratio(launches(*gm), launches(*cm)));
        }
    }
    if (text.empty()) return text;
    return fmt::format("{:<60} {:<9} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n",
                       fmt::format("how many times {} is faster", base), "device", "total", "narrow",
                       "kernels", "read", "write", "launches")
           + text;
}

} // namespace tandem
