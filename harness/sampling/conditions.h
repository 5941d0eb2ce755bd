// SPDX-License-Identifier: MIT
#pragma once

#include "backends/gpu_condition.h"
#include "harness/plans/device_groups.h"
#include "harness/sampling/processor_condition.h"

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tandem {

/// The condition of the machine at a reading, and since the previous reading.
struct Condition {
    ProcessorCondition processor;
    std::vector<GpuCondition> gpus; ///< by device of the cell; all values unknown for a processor

    bool operator==(const Condition&) const = default;
};

/// Reads the condition under which a cell is measured. Differences are relative to the previous reading, for
/// the first reading to the construction. Read before and after a sample, never within a timed span.
class ConditionReader {
public:
    /// The devices need not outlive this object. `root` and `own` are passed to ProcessorReader.
    explicit ConditionReader(const DeviceGroup& devices, std::string root = "/",
                             std::function<OwnUse()> own = own_use);

    /// Never fails: values that cannot be read stay unknown.
    Condition read();

private:
    ProcessorReader processor_;
    std::vector<GpuGauge> gauges_;
    bool takes_turns_; ///< with another process, which does not compute while this one does
};

/// Limits above which a sample is doubtful.
struct Thresholds {
    /// Fraction of the cores that other processes use. Services of an idle machine use under 1 %, and
    /// counting in ticks has an error of up to 4 % in ProcessorReader's shortest period.
    double other_processes = 0.10;
    std::uint64_t throttled = 0; ///< periods with an exhausted quota
    unsigned processes = 0;      ///< other processes that compute on a GPU
};

/// Why a sample between two consecutive readings is doubtful: "busy: other processes use 0.8 of 2 cores;
/// throttled: power cap". Empty when no known value exceeds its threshold.
std::optional<std::string> disturbance(const Condition& before, const Condition& after,
                                       const Thresholds& thresholds = {});

namespace record_parts {

struct Type;
/// The type of conditions_json().
Type condition_type();

} // namespace record_parts

/// JSON with units in the names. Unknown values are null; so is a device without any known value.
nlohmann::ordered_json condition_json(const Condition& condition);
/// The same form for one or more readings of the same devices. A constant value appears once, a varying one
/// as an array with one element a reading, which keeps records short. Reasons of throttling are one text. A
/// device that is unknown at a reading has null for every value of that reading.
nlohmann::ordered_json conditions_json(std::span<const Condition> conditions);
nlohmann::ordered_json gpu_condition_json(const GpuCondition& condition);

/// The known values as "1980 MHz SM, 3201 MHz memory, 34 C, 76 of 700 W"; empty when none is known.
std::string gpu_condition_text(const GpuCondition& condition);

} // namespace tandem
