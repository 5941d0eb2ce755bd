// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"

namespace tandem {

/// The cells that `auto` chooses from on these devices: every algorithm with the presets of the request
/// (default: its first) and every alternative of its settings. Settings in `given` are fixed. All candidates
/// give the same answer as the first: its pairs, or its contacts where those are equal for every k. The
/// devices run no two of them alike. Those with the fewest changes to their preset come first. Throws
/// InputError when none fits the devices.
std::vector<Cell> candidates(const Request& request, const SettingTexts& given, const DeviceGroup& devices);

/// Whether candidates with the settings of this one may differ in k. They find the same number of contacts,
/// but not of pairs.
bool may_differ_in_k(const Cell& candidate);

/// A cell with these candidates, before the choice.
Cell undecided_cell(const Request& request, const SettingTexts& given, const DeviceGroup& devices);

} // namespace tandem
