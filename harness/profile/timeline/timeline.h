// SPDX-License-Identifier: MIT
// The commands of a frame as a trace that Perfetto (ui.perfetto.dev) and chrome://tracing show: a process a
// device, with a lane each for the host's calls, its own work and its waits, and for the device's kernels,
// transfers and stages.
#pragma once

#include "backends/device.h"

#include <cstdio>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace tandem {

/// One device's part of a frame.
struct DeviceTimeline {
    DeviceInfo info;
    Trace trace;
};

/// An object of the trace event format (microseconds from the first call). Clocks of device and host are not
/// one: device times are moved by the least that lets no command begin before the call that submitted it;
/// `otherData` says by how much, and what could be said against it. Of commands without device times there
/// are the calls only.
nlohmann::ordered_json timeline_json(std::span<const DeviceTimeline> devices, const std::string& cell,
                                     std::size_t frame);

/// A file that is there whole or not at all.
class TimelineFile {
public:
    /// Makes sure that it can be written, beside its place. Throws InputError. An empty path writes nowhere.
    explicit TimelineFile(const std::string& path);
    ~TimelineFile();
    TimelineFile(const TimelineFile&) = delete;
    TimelineFile& operator=(const TimelineFile&) = delete;

    explicit operator bool() const { return file_ != nullptr; }
    /// Writes and puts it in its place, over what was there; once. Throws OutputError.
    void write(const nlohmann::ordered_json& timeline);

private:
    std::string path_, part_;
    std::FILE* file_ = nullptr;
};

} // namespace tandem
