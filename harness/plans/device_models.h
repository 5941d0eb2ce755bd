// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <string>
#include <string_view>

namespace tandem {

/// What devices are asked for by where no number in a machine says anything: "cuda:H100", "opencl:EPYC",
/// "host:Xeon" is a device of a back end whose model has that text in its name; "cuda:each", "each" is one
/// device of every model that there is.
inline constexpr std::string_view each_model = "each";

/// What the vendor calls it; of device host the processor.
std::string model_name(const DeviceInfo& info);

/// "cuda" of "cuda:0", "cuda:H100" and "cuda".
std::string_view backend_of(std::string_view name);

/// Whether the word asks for a model: a back end and what is neither a number nor "each".
bool asks_for_model(std::string_view word);

/// Whether the device is of the model that such a word asks for; upper and lower case are the same.
bool is_of_model(const DeviceInfo& info, std::string_view word);

/// Whether the word asks for one of every model, and whether those of the device's back end are among them.
bool asks_for_each(std::string_view word);
bool is_among(const DeviceInfo& info, std::string_view each);

/// What stands for a device in a key: "cuda:NVIDIA H200, CUDA 13.0, 580.159.04"; a processor with the number
/// of its cores, "host:AMD EPYC x2, g++ 12.2.0, lanes for x86-64-v3".
std::string model_of(const DeviceInfo& info);

} // namespace tandem
