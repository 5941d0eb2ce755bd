// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tandem {

/// What the processor was like until a reading; what Linux does not tell is unknown.
struct ProcessorCondition {
    unsigned cores = 0;                  ///< that this process may run on
    std::optional<double> quota;         ///< cores that its control group leaves it; none without a limit
    std::optional<double> own;           ///< mean number of these cores busy with this process
    std::optional<double> others;        ///< and with anything else, other guests of the machine included
    std::optional<std::string> governor; ///< of these cores' clocks; "mixed" when they differ
    std::optional<double> mhz;           ///< mean clock of these cores
    std::optional<std::uint64_t>
        throttled;                  ///< periods since the reading before in which the quota was used up
    std::optional<double> pressure; ///< percent of the last 10 s in which a task waited for a core, ours too

    bool operator==(const ProcessorCondition&) const = default;
};

/// This process by its own account.
struct OwnUse {
    std::vector<unsigned> cores; ///< that its calling thread may run on
    double seconds = 0;          ///< processor time of all its threads since it began
};

OwnUse own_use();

/// Reads conditions of the processor. `own` and `others` are means over a period of shortest_period or more,
/// which began at the construction or where the one before ended: Linux counts in hundredths of a second. A
/// reading within a period repeats what is known of the last; before the first has ended they are unknown.
/// Clocks are asked of at most most_cores_asked cores, since each answer may take a core out of its sleep.
class ProcessorReader {
public:
    static constexpr double shortest_period = 0.25; ///< seconds
    static constexpr unsigned most_cores_asked = 16;

    /// `root` stands before every path under /proc and /sys.
    explicit ProcessorReader(std::string root = "/", std::function<OwnUse()> own = own_use);

    /// Never throws; takes a fraction of a millisecond, outside of any span that is timed.
    ProcessorCondition read();

private:
    /// Seconds since the machine began, on the cores of this process.
    struct Load {
        std::vector<unsigned> cores;
        double elapsed = 0; ///< of one core
        double busy = 0;    ///< of all of them
        double own = 0;
    };

    std::optional<Load> load(const OwnUse& use) const;
    void take_load(const OwnUse& use);
    std::optional<std::uint64_t> take_throttled(std::optional<std::uint64_t> now);

    std::string root_;
    std::function<OwnUse()> own_use_;
    std::optional<Load> base_; ///< where the period began that has not ended
    std::optional<double> own_, others_;
    std::optional<std::uint64_t> throttled_;
};

} // namespace tandem
