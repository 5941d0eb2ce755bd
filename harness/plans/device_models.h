// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <string>
#include <string_view>

namespace tandem {

/// Names of devices by model, for plans that are valid on any machine: "cuda:H100", "opencl:EPYC" and
/// "host:Xeon" name a device of a backend whose model name contains that text. "cuda:each" and "each" name
/// one device of every available model.
inline constexpr std::string_view each_model = "each";

/// The vendor's name of the device; for device host, the name of the processor.
std::string model_name(const DeviceInfo& info);

/// "cuda" of "cuda:0", "cuda:H100" and "cuda".
std::string_view backend_of(std::string_view name);

/// Whether the word names a model: a backend, a colon, and neither a number nor "each".
bool asks_for_model(std::string_view word);

/// Whether such a word names the model of this device. The comparison ignores case.
bool is_of_model(const DeviceInfo& info, std::string_view word);

/// Whether the word names one device of every model.
bool asks_for_each(std::string_view word);
/// Whether such a word includes the device's backend.
bool is_among(const DeviceInfo& info, std::string_view each);

/// The text for a device in a key: "cuda:NVIDIA H200, CUDA 13.0, 580.159.04". A processor has the number of
/// its cores: "host:AMD EPYC x2, g++ 12.2.0, lanes for x86-64-v3".
std::string model_of(const DeviceInfo& info);

} // namespace tandem
