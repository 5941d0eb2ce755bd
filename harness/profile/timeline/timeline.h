// SPDX-License-Identifier: MIT
// The commands of a frame as a trace for Perfetto (ui.perfetto.dev) and chrome://tracing. Each device is a
// process with lanes for the host's calls, its own work and its waits, and for the device's kernels,
// transfers and stages.
#pragma once

#include "backends/device.h"

#include <cstdio>
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

/// A file that is written atomically: whole or not at all.
class TimelineFile {
public:
    /// Opens a temporary file beside `path`. Throws InputError when it cannot be written. With an empty path
    /// nothing is written.
    explicit TimelineFile(const std::string& path);
    ~TimelineFile();
    TimelineFile(const TimelineFile&) = delete;
    TimelineFile& operator=(const TimelineFile&) = delete;

    explicit operator bool() const { return file_ != nullptr; }
    /// Writes the timeline and replaces the file at the path. Call it at most once. Throws OutputError.
    void write(const nlohmann::ordered_json& timeline);

private:
    std::string path_, temporary_;
    std::FILE* file_ = nullptr;
};

} // namespace tandem
