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

/// What the machine was like at a reading, and since the one before.
struct Condition {
    ProcessorCondition processor;
    std::vector<GpuCondition> gpus; ///< one for each device of the cell, in order; all unknown of processors

    bool operator==(const Condition&) const = default;
};

/// Reads the condition that a cell is measured under. Differences are taken from the reading before, the
/// first one's from the construction. Readings belong before and after a sample, never into a span that is
/// timed.
class ConditionReader {
public:
    /// The devices are not kept. `root` and `own` are ProcessorReader's.
    explicit ConditionReader(const DeviceGroup& devices, std::string root = "/",
                             std::function<OwnUse()> own = own_use);

    /// Never fails: what cannot be read is unknown.
    Condition read();

private:
    ProcessorReader processor_;
    std::vector<GpuGauge> gauges_;
};

/// From where on a sample is doubtful.
struct Thresholds {
    /// Share of the cores that others take. An idle machine's services take under one in a hundred, and
    /// counting in ticks errs by up to four in ProcessorReader's shortest period.
    double others = 0.10;
    std::uint64_t throttled = 0; ///< periods with the quota used up; more are too many
    unsigned processes = 0;      ///< others that compute on a GPU; more are too many
};

/// Why a sample between the two readings, which follow each other, is doubtful, in a few words: "busy: others
/// take 0.8 of 2 cores; throttled: power cap". None where nothing speaks against it, as far as is known.
std::optional<std::string> disturbance(const Condition& before, const Condition& after,
                                       const Thresholds& thresholds = {});

/// With units in the names; unknown is null, as is the whole of a device of which nothing is known.
nlohmann::ordered_json condition_json(const Condition& condition);
/// Of one or more readings of the same devices in that form: what was the same at each stands by itself, what
/// was not as an array, one a reading, for most never changes and there are many rounds; reasons of
/// throttling as one text. Of a device of which nothing was known at one reading, all is null there.
nlohmann::ordered_json conditions_json(std::span<const Condition> conditions);
nlohmann::ordered_json gpu_condition_json(const GpuCondition& condition);

/// "1980 MHz SM, 3201 MHz memory, 34 C, 76 of 700 W", as far as known; empty when nothing is.
std::string gpu_condition_text(const GpuCondition& condition);

} // namespace tandem
