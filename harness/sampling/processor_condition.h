// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tandem {

/// The condition of the processor up to a reading; values that Linux does not report are empty.
struct ProcessorCondition {
    unsigned cores = 0;                     ///< cores that this process may run on
    std::optional<double> quota;            ///< cores of its control group's quota; empty without a limit
    std::optional<double> own;              ///< mean number of these cores busy with this process
    std::optional<double> other_processes;  ///< mean number busy with other processes or virtual machines
    std::optional<std::string> governor;    ///< frequency governor of these cores; "mixed" when they differ
    std::optional<double> mhz;              ///< mean clock of these cores
    std::optional<std::uint64_t> throttled; ///< periods since the previous reading with an exhausted quota
    std::optional<double> pressure;         ///< percent of the last 10 s in which any task waited for a core

    bool operator==(const ProcessorCondition&) const = default;
};

/// Processor use of this process.
struct OwnUse {
    std::vector<unsigned> cores; ///< cores that the calling thread may run on
    double seconds = 0;          ///< processor time of all threads since the process began
};

OwnUse own_use();

/// Seconds since the machine started, on the cores of this process.
struct ProcessorLoad {
    std::vector<unsigned> cores;
    double elapsed = 0; ///< of one core
    double busy = 0;    ///< of all of them
    double own = 0;
};

/// Reads conditions of the processor. `own` and `others` are means over consecutive periods of at least
/// shortest_period, because Linux counts in hundredths of a second. A reading within a period repeats the
/// values of the last one; they are unknown before the first period ends. Reads the clocks of at most
/// most_sampled_cores cores, because reading a clock can wake a core.
class ProcessorReader {
public:
    static constexpr double shortest_period = 0.25; ///< seconds
    static constexpr unsigned most_sampled_cores = 16;

    /// `root` is the prefix of every path under /proc and /sys.
    explicit ProcessorReader(std::string root = "/", std::function<OwnUse()> own = own_use);

    /// Calls `wait`, and leaves the processor use meanwhile out of the values of all readers of this process.
    static void leave_out(const std::function<void()>& wait, const std::string& root = "/",
                          const std::function<OwnUse()>& own = own_use);

    /// Never throws. Lasts a fraction of a millisecond: do not call it within a timed span.
    ProcessorCondition read();

private:
    void update_load(const OwnUse& use);
    std::optional<std::uint64_t> update_throttled(std::optional<std::uint64_t> now);

    std::string root_;
    std::function<OwnUse()> own_use_;
    std::optional<ProcessorLoad> base_; ///< at the beginning of the current period
    std::optional<double> own_, other_processes_;
    std::optional<std::uint64_t> throttled_;
};

} // namespace tandem
