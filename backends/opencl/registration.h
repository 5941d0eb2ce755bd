// SPDX-License-Identifier: MIT
// How drivers are registered: files `*.icd` of a folder, each with the name of a library in its first line.
#pragma once

#include "backends/driver_report.h"

#include <string>
#include <vector>

namespace tandem::opencl {

/// What OCL_ICD_VENDORS names (a folder, an .icd file or a library), else the files of OPENCL_VENDOR_PATH,
/// else those of /etc/OpenCL/vendors; then the libraries of OCL_ICD_FILENAMES, separated by colons. Rules of
/// ocl-icd 2.3 and of the Khronos loader. No library is loaded; `problem` says why a file names none.
std::vector<DriverReport> read_registration();

} // namespace tandem::opencl
