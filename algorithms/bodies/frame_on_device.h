// SPDX-License-Identifier: MIT
// What the host has to say of frames in a device's memory: whether they fit a scene, and what is wrong with
// one that kernels have found to be out of range.
#pragma once

#include "algorithms/device_frame.h"

namespace tandem {

/// Throws InputError that names the first buffer that is missing or too small for the scene's bodies.
void check_fits(const Scene& scene, const DeviceFrame& frame);

/// The frame in the host's memory; waits. Throws InputError for the first row without a rotation.
Frame downloaded(Device& device, const Scene& scene, const DeviceFrame& frame);

/// Throws the InputError that the same frame has in the host's memory: of `flawed` rows, one at least.
[[noreturn]] void refuse_flawed(Device& device, const Scene& scene, const DeviceFrame& frame,
                                Precision precision, std::uint64_t flawed);

} // namespace tandem
