// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/run_options.h"
#include "harness/frames/frames.h"

namespace tandem {

/// Prints what readers found in the meshes of a scene: one line a mesh file, on standard error. For commands
/// that open a scene for a user; print_scene() (task.h) calls it.
void report_findings(const Scene& scene);

/// Opens the scene of the options: a kind, a description, or mesh files with poses. Throws InputError.
Scene open_scene(const RunOptions& options);

/// Opens the frames of the options and handles their flaws. Throws InputError when the scene has no such
/// frames or they are refused. The scene must outlive the result and must not move.
/// `bounds_motion`: frames need successors.
FrameRange open_frames(const RunOptions& options, const Scene& scene, bool bounds_motion);

/// Whether a cell has motion=linear.
bool bounds_motion(std::span<const Cell> cells);

/// The first and the last frame of "FIRST:LAST" or "N"; all when empty, but without the last if frames need
/// successors. Throws InputError as open_frames().
std::pair<std::size_t, std::size_t> named_frames(const std::string& frames, const Scene& scene,
                                                 bool bounds_motion = false);

/// Opens the backends of the named and the required devices of a command, and checks that the required ones
/// are there. Where a name is default_device, prints a line that says which device that is, and why. Throws
/// InputError.
std::vector<BackendReport> open_named(std::span<const std::string> names,
                                      const std::vector<std::string>& require);

/// The named devices, limited to --memory. Throws InputError.
std::vector<DeviceGroup> open_devices(const RunOptions& options, const std::vector<BackendReport>& backends,
                                      std::span<const std::string> names);

/// Limits all devices to --memory.
void limit_memory(const RunOptions& options, const std::vector<BackendReport>& backends);

/// Throws InputError for the first name that is neither a device nor a backend with devices.
void check_required(const std::vector<BackendReport>& backends, const std::vector<std::string>& require);

/// Refuses coordinates that the precision of the cell cannot represent. Called before anything is measured.
void check_coordinates(const Cell& cell, const Scene& scene, const Frame& frame);
void check_coordinates(const Cell& cell, const Scene& scene, const FrameRange& range);

/// Refuses dumps that a cell cannot produce, and two outputs in one file.
void check_outputs(const RunOptions& options, std::span<const Cell> cells);

} // namespace tandem
