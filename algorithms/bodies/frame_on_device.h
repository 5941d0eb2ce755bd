// SPDX-License-Identifier: MIT
// Checks on the host for frames in a device's memory: whether a frame fits its scene, and the error for a
// frame in which kernels have found rows out of range.
#pragma once

#include "algorithms/bodies/frame_input.h"
#include "algorithms/bounds/geometry.h"

namespace tandem {

/// Throws InputError that names the first missing buffer, or the first that is too small for the scene.
/// `deformable`: deformable_bodies(scene).
void check_fits(const Scene& scene, std::span<const std::uint32_t> deformable, const DeviceFrame& frame);

/// Downloads the frame; waits. Throws InputError for the first row without a rotation.
Frame downloaded(Device& device, const Scene& scene, const DeviceFrame& frame);

/// Throws the InputError that check_range throws for the same frame in the host's memory, or of_successor for
/// its successor. `flawed`: number of rows out of range, at least 1.
[[noreturn]] void refuse_flawed(Device& device, const Scene& scene, const DeviceFrameInput& input,
                                const Geometry& geometry, std::uint64_t flawed);

} // namespace tandem
