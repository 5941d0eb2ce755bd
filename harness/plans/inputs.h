// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands/commands.h"
#include "harness/plans/frames.h"

namespace tandem {

/// The scene that the options name: a kind, a description, or mesh files with poses. Throws InputError.
Scene open_scene(const RunOptions& options);

/// The frames that the options name, their flaws handled as they say. Throws InputError when the scene has no
/// such frames or they are refused. The scene must outlive them, in its place.
FrameRange open_frames(const RunOptions& options, const Scene& scene);

/// The first and the last frame of "FIRST:LAST" or "N", all when empty; throws InputError as open_frames.
std::pair<std::size_t, std::size_t> named_frames(const std::string& frames, const Scene& scene);

/// The devices that the options name, limited to --memory. Throws InputError.
std::vector<DeviceGroup> open_devices(const RunOptions& options, const std::vector<BackendReport>& backends,
                                      std::span<const std::string> names);

/// Limits all devices to --memory.
void limit_memory(const RunOptions& options, const std::vector<BackendReport>& backends);

/// Throws InputError for each name that is no backend with devices and no device.
void check_required(const std::vector<BackendReport>& backends, const std::vector<std::string>& require);

/// Refuses coordinates that the precision of the cell cannot hold, before anything is measured.
void check_coordinates(const Cell& cell, const Scene& scene, const Frame& frame);
void check_coordinates(const Cell& cell, const Scene& scene, const FrameRange& range);

/// Refuses dumps that no cell can give, and two outputs in one file.
void check_outputs(const RunOptions& options, std::span<const Cell> cells);

} // namespace tandem
