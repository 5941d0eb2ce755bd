// SPDX-License-Identifier: MIT
// Files of records with times of the tests' own, compared.
#pragma once

#include "harness/compare/report.h"
#include "tests/unit/compare_records.h"

#include <numeric>

namespace tandem::compare {

/// 10 ms and a little, another in each of `count` samples, times `factor`.
inline std::vector<double> around(double factor, std::size_t count) {
    std::vector<double> times;
    for (std::size_t i = 0; i < count; ++i)
        times.push_back(factor * (1e7 + 1000.0 * static_cast<double>(i * 7 % 11)));
    return times;
}

inline nlohmann::json in_rounds(const std::string& key, const std::vector<double>& samples,
                                const char* session) {
    std::vector<int> rounds(samples.size());
    std::iota(rounds.begin(), rounds.end(), 0);
    return record(key, samples, rounds, session);
}

/// Two files that are compared.
struct Compared {
    Compared(const Records& before_records, const Records& after_records, const Options& how = {})
        : old_file(before_records),
          new_file(after_records),
          options(how),
          before(read_cells(old_file.path(), "")),
          after(read_cells(new_file.path(), "")),
          comparison(compare(before, after, options)) {}

    Report report() const { return {before, after, options, comparison}; }
    const ComparedCell& cell() const { return comparison.cells.front(); }

    TemporaryFile old_file, new_file;
    Options options;
    RecordedCells before, after;
    Comparison comparison;
};

} // namespace tandem::compare
