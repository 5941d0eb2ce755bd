// SPDX-License-Identifier: MIT
// Everything that a program needs to find pairs and contacts: scenes, devices, algorithms, settings, errors.
// Installed as <tandem/tandem.h>.
#pragma once

#include <tandem/algorithms/bodies/device_frame.h>
#include <tandem/algorithms/parameters/table.h>
#include <tandem/algorithms/traversal.h>
#include <tandem/backends/cuda/cuda_device.h>
#include <tandem/backends/device.h>
#include <tandem/backends/host/host_device.h>
#include <tandem/backends/opencl/opencl_device.h>
#include <tandem/backends/registry.h>
#include <tandem/base/error.h>
#include <tandem/scenes/contact.h>
#include <tandem/scenes/scene.h>
