// SPDX-License-Identifier: MIT
// The drivers that are registered with the ICD loader. The loader leaves out those that fail and gives no
// reason, so that this file reads the same registration and asks each library.
#pragma once

#include "backends/driver_report.h"
#include "backends/opencl/cl.h"

#include <string>
#include <vector>

namespace tandem::opencl {

/// The registered drivers in the order of their files' names. Call it after clGetPlatformIDs(): a library
/// counts as working only if the loader has loaded it. Never throws for a driver that fails.
std::vector<DriverReport> registered_drivers();

/// Why the kernel cache of a device's driver cannot be written, and what to do; empty when it can, or is
/// unknown.
std::string cache_problem(cl_device_id device);

/// "FILE (LIBRARY): PROBLEM".
std::string sentence(const DriverReport& driver);

} // namespace tandem::opencl
