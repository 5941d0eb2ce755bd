// SPDX-License-Identifier: MIT
// OpenCL's declarations. Other files include this header instead, so that all have the same version of them.
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
