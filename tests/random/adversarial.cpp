// SPDX-License-Identifier: MIT
// adversarial [--pairs N] [--device D,E] [--family F,G] ...: N pairs in total, spread over the families of
// hard cases. The kernels of the traversals bound and test them on every device; the results are compared
// with the exact truth. Prints the commit, one line per family and a summary; exit code 1 if a pair is
// missed.
// adversarial --counter E [--algorithm A,B] [--device D,E]: every algorithm counts 2^E pairs; exit code 1 if
// a count is wrong. --help lists all options.
// when a count is wrong. --help lists all options.
#include "backends/registry.h"
#include "harness/verify/adversarial.h"
#include "harness/program/environment.h"
#include "harness/plans/cells.h"
#include "harness/sampling/measurement.h"
#include "base/error.h"
#include "tests/support/tried.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <numeric>

namespace tandem {
namespace {

struct Options {
    std::uint64_t pairs = 1000000;
    std::vector<std::string> devices{"all"}, families;
    std::vector<int> k{6, 8, 14, 18, 26};
    std::string rounding = "safe";
    int exponent = 0; ///< if not 0: count 2^exponent pairs instead
    std::vector<std::string> algorithms;
    AdversarialOptions run;
};

std::vector<const HardFamily*> chosen(const Options& options) {
    std::vector<const HardFamily*> result;
    for (const auto& name : options.families) result.push_back(&hard_family(name));
    if (!result.empty()) return result;
    for (const auto& family : hard_families())
        if (is_adversarial(family)) result.push_back(&family);
    return result;
}

std::vector<AdversarialCell> cells_of(const Options& options, const std::vector<BackendReport>& backends) {
    const auto rounding = options.rounding == "safe" ? Rounding::safe : Rounding::nearest;
    std::vector<AdversarialCell> cells;
    for (const auto& group : choose_devices(backends, options.devices))
        for (auto* device : group)
            for (const int k : options.k) cells.push_back({device, {.k = k, .rounding = rounding}});
    return cells;
}

std::uint64_t total(const std::vector<std::uint64_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

void print(std::string_view name, const AdversarialTally& t) {
    fmt::print("{:<20} {:>11} {:>11} {:>11} {:>11} {:>6} {:>8} {:>8.2f} {:>8.2f}\n", name, t.pairs,
               t.touching, t.overlapping, t.decided, t.contradictions, total(t.missed), t.truth_seconds,
               t.test_seconds);
    std::fflush(stdout);
}

std::string name_of(const AdversarialCell& cell) {
    return fmt::format("{} k={}", cell.device->info().id, cell.geometry.k);
}

int run(const Options& options) {
    const auto backends = discover();
    const auto families = chosen(options);
    const auto cells = cells_of(options, backends);
    if (cells.empty()) throw InputError("no device; see 'tandem devices'");
    auto each = options.run;
    each.pairs = (options.pairs + families.size() - 1) / families.size();
    AdversarialTally sum;
    fmt::print("{:<20} {:>11} {:>11} {:>11} {:>11} {:>6} {:>8} {:>8} {:>8}\n", "family", "pairs", "touching",
               "overlapping", "by oracle", "wrong", "missed", "truth s", "test s");
    for (const auto* family : families) {
        const auto tally = run_adversarial(*family, cells, each);
        print(family->name, tally);
        if (tally.first)
            fmt::print("  first missed: {}, difficulty {}, pair {} of seed {}\n",
                       name_of(cells[tally.first->cell]), tally.first->difficulty, tally.first->index,
                       tally.first->seed);
        sum.add(tally);
    }
    print("all", sum);
    for (std::size_t i = 0; i < cells.size(); ++i)
        fmt::print("{:<20} {} missed, {} false of {} found\n", name_of(cells[i]), sum.missed[i],
                   sum.false_pairs[i], sum.false_pairs[i] + sum.touching + sum.overlapping - sum.missed[i]);
    const double seconds = sum.truth_seconds + sum.test_seconds;
    fmt::print("{} pairs in each of {} cells, {} missed; {:.2f} million pairs a second, {:.2f} million tests "
               "a second\n",
               sum.pairs, cells.size(), total(sum.missed), 1e-6 * static_cast<double>(sum.pairs) / seconds,
               1e-6 * static_cast<double>(sum.pairs * cells.size()) / sum.test_seconds);
    std::string where;
    for (const auto& group : choose_devices(backends, options.devices))
        for (const auto* device : group) // a device behind two interfaces counts once
            if (where.find(device->info().name) == std::string::npos)
                where += (where.empty() ? "" : ", ") + device->info().name;
    if (options.rounding == "safe")
        support::tried(
            "pairs of hard families, with five values of k, against the exact truth (`adversarial`)",
            sum.pairs, "pairs", where, total(sum.missed));
    return sum.ok() ? 0 : 1;
}

/// Runs every algorithm once over 2^exponent pairs with output=count.
int count(const Options& options) {
    const auto scene = make_scene(fmt::format("hard:counter-wrap:difficulty={}", options.exponent));
    const auto expected = hard_family("counter-wrap").meeting(options.exponent);
    const auto backends = discover();
    Request request;
    request.algorithms = options.algorithms;
    request.sets = {{"output", {"count"}}};
    int code = 0;
    for (const auto& cell : plan(request, choose_devices(backends, options.devices))) {
        const auto begin = std::chrono::steady_clock::now();
        const auto result = cell.algorithm->prepare(cell.devices, scene, cell.settings)->run(scene.frame(0));
        const double seconds = 1e-9 * static_cast<double>(since(begin));
        fmt::print("{}: {} pairs of {} in {:.1f} s\n", describe(cell), result.count, expected, seconds);
        std::fflush(stdout);
        if (result.count != expected) code = 1;
    }
    return code;
}

int dispatch(int argc, char** argv) {
    Options options;
    CLI::App app{"adversarial: pairs of every family of hard cases against the exact truth"};
    app.add_option("--pairs", options.pairs, "in all, spread over the families")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40));
    app.add_option("--device", options.devices, "D,E or all")->delimiter(',');
    app.add_option("--k", options.k, "planes of the k-DOPs")
        ->delimiter(',')
        ->check(CLI::IsMember({6, 8, 14, 18, 26}));
    app.add_option("--rounding", options.rounding, "safe or nearest, which may miss")
        ->check(CLI::IsMember({"safe", "nearest"}));
    app.add_option("--family", options.families, "F,G; all when left out")->delimiter(',');
    app.add_option("--batch", options.run.batch, "pairs in one launch")->check(CLI::Range(1, 1 << 24));
    app.add_option("--seed", options.run.seed, "of all pairs");
    app.add_option("--sample", options.run.sample,
                   "of so many pairs known by construction the oracle decides one as well")
        ->check(CLI::PositiveNumber);
    auto* counter =
        app.add_option("--counter", options.exponent,
                       "instead: 2^N pairs by every algorithm, with output=count (hard:counter-wrap)")
            ->check(CLI::Range(1, 34));
    app.add_option("--algorithm", options.algorithms, "A,B for --counter")->delimiter(',')->needs(counter);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const auto made_by = environment();
    fmt::print("commit {}{}, {}\n", made_by.commit.empty() ? "unknown" : made_by.commit,
               made_by.dirty ? " and changes" : "", made_by.date);
    return options.exponent > 0 ? count(options) : run(options);
}

} // namespace
} // namespace tandem

int main(int argc, char** argv) {
    try {
        return tandem::dispatch(argc, argv);
    } catch (const tandem::InputError& error) {
        fmt::print(stderr, "adversarial: {}\n", error.what());
        return 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "adversarial: {}\n", error.what());
        return 3;
    }
}
