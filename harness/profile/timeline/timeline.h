// SPDX-License-Identifier: MIT
// The commands of a frame as a trace for Perfetto (ui.perfetto.dev) and chrome://tracing. Each device is a
// process with lanes for the host's calls, its own work and its waits, and for the device's kernels,
// transfers and stages.
#pragma once

#include "backends/device.h"
#include "base/whole_file.h"

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace tandem {

/// The commands of one device in a frame.
struct DeviceTimeline {
    DeviceInfo info;
    Trace trace;
};

/// An object of the trace event format, in microseconds from the first call. Device and host have different
/// clocks: device times are shifted by the least offset with which no command begins before the call that
/// submitted it. `otherData` has the offset and its upper bound. Commands without device times appear as
/// calls only.
nlohmann::ordered_json timeline_json(std::span<const DeviceTimeline> devices, const std::string& cell,
                                     std::size_t frame);

/// A file that is written whole or not at all.
class TimelineFile {
public:
    /// Throws InputError when the file cannot be written. With an empty path nothing is written.
    explicit TimelineFile(const std::string& path);

    explicit operator bool() const { return static_cast<bool>(file_); }
    /// Writes the timeline and replaces the file at the path. Call it at most once. Throws OutputError.
    void write(const nlohmann::ordered_json& timeline);

private:
    WholeFile file_;
};

} // namespace tandem
