// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"

namespace tandem {

/// What `auto` may choose from on these devices: every algorithm with the presets of the request, by default
/// its first, and of every setting with alternatives each of these, unless it is among `given`, which all
/// have. Only cells with the answer of the first are among them, and of cells that a device takes alike one.
/// Those that differ least from their presets come first. Throws InputError when none fits the devices.
std::vector<Cell> candidates(const Request& request, const SettingTexts& given, const DeviceGroup& devices);

/// The cell that is to become one of them.
Cell undecided_cell(const Request& request, const SettingTexts& given, const DeviceGroup& devices);

} // namespace tandem
