// SPDX-License-Identifier: MIT
// How often comparisons are wrong and right, over many simulated pairs of records.
#include "harness/compare/compare.h"
#include "tests/unit/compare_noise.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tandem::compare {
namespace {

RecordedCell cell_of(const std::string& key, const std::vector<double>& times, const std::string& session) {
    RecordedCell cell;
    cell.key = key;
    cell.status = "ok";
    cell.schema = 3;
    cell.on_gpus = true;
    cell.session = session;
    for (std::size_t i = 0; i < times.size(); ++i)
        cell.rounds.push_back({static_cast<std::int64_t>(i), times[i]});
    return cell;
}

struct Trial {
    std::size_t cells = 1, rounds = 10;
    bool paired = false;
    double noise = 0.02; ///< of a round
    double drift = 0;    ///< of the machine from round to round, shared by interleaved cells
    double change = 0;   ///< of the logarithm of every new time of the first cell
    std::size_t times = 2000;
};

/// Share of trials in which anything is found to have changed, by however little.
double found(const Trial& trial, std::uint64_t start) {
    Noise noise(start);
    Options options;
    options.threshold = 0;
    std::size_t count = 0;
    for (std::size_t time = 0; time < trial.times; ++time) {
        RecordedCells before;
        RecordedCells after;
        for (std::size_t i = 0; i < trial.cells; ++i) {
            const auto drift = noise.normal(trial.rounds, trial.drift);
            auto old_times = noise.times(trial.rounds, trial.noise);
            auto new_times = noise.times(trial.rounds, trial.noise);
            for (std::size_t round = 0; round < trial.rounds; ++round) {
                old_times[round] *= std::exp(drift[round]);
                new_times[round] *= std::exp(drift[round] + (i == 0 ? trial.change : 0));
            }
            const auto key = std::to_string(i);
            before.cells.push_back(cell_of(key, old_times, trial.paired ? "one" : "a"));
            after.cells.push_back(cell_of(key, new_times, trial.paired ? "one" : "b"));
        }
        count += compare(before, after, options).changed() ? 1 : 0;
    }
    return static_cast<double>(count) / static_cast<double>(trial.times);
}

/// Four standard errors of a share of so many trials.
double error(double share, double times) { return 4 * std::sqrt(share * (1 - share) / times); }

TEST(CompareRates, NothingChangedIsFoundAsOftenAsTheTestsSay) {
    Trial trial;
    trial.paired = true; // 10 pairs: 50 of 1,024 sets of signs
    EXPECT_NEAR(found(trial, 11), 50.0 / 1024, error(50.0 / 1024, 2000));
    trial.drift = 0.2; // shared by both of a pair
    EXPECT_NEAR(found(trial, 12), 50.0 / 1024, error(50.0 / 1024, 2000));
    trial.paired = false; // 10 against 10, U of 23 or less: 4.33 %
    trial.drift = 0;
    EXPECT_NEAR(found(trial, 13), 0.0433, error(0.0433, 2000));
}

TEST(CompareRates, ManyCellsTogetherRaiseNoMoreFalseAlarms) {
    Trial trial;
    trial.cells = 20;
    trial.rounds = 12;
    trial.times = 150;
    for (const bool paired : {false, true}) {
        trial.paired = paired;
        EXPECT_LE(found(trial, 14), 0.05 + error(0.05, 150)) << paired;
    }
    trial.change = 0.2; // of one, which is found among 19 others
    trial.times = 20;
    EXPECT_EQ(found(trial, 15), 1);
}

/// The change that the standard error of medians calls for, and how often it is found.
void expect_power(Trial trial, double variance, std::uint64_t start) {
    const double median_error = trial.noise * std::sqrt(variance / static_cast<double>(trial.rounds));
    trial.change = std::log1p(least_effect(median_error, 0.05, power));
    trial.times = 1000;
    // Rank tests use more of normal noise than medians do, so they find it more often.
    const double share = found(trial, start);
    EXPECT_GT(share, 0.8 - error(0.8, 1000)) << trial.rounds;
    EXPECT_LT(share, 0.99) << trial.rounds;
}

TEST(CompareRates, LeastEffectIsShownFourTimesOfFive) {
    constexpr double of_median =
        1.5707963267948966; // variance of a median over that of a mean, for normal noise
    Trial trial;
    for (const std::size_t rounds : {8, 20}) {
        trial.rounds = rounds;
        trial.paired = true;
        expect_power(trial, 2 * of_median, 16);
        trial.paired = false;
        expect_power(trial, 2 * of_median, 17);
    }
}

TEST(CompareRates, PairsSeeThroughDrift) {
    Trial trial;
    trial.drift = 0.1;
    trial.noise = 0.005;
    trial.change = 0.02;
    trial.times = 200;
    EXPECT_LT(found(trial, 18), 0.2);
    trial.paired = true;
    EXPECT_GT(found(trial, 18), 0.99);
}

} // namespace
} // namespace tandem::compare
