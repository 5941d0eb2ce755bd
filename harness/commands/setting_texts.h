// SPDX-License-Identifier: MIT
// Texts about the settings of algorithms, from their declarations.
#pragma once

#include "algorithms/traversal.h"

#include <string>
#include <vector>

namespace tandem {

/// The words that are values.
std::vector<std::string> words_of(const Parameter& parameter);

/// The values that auto tries.
std::vector<std::string> alternatives_of(const Parameter& parameter);

/// "1..1024", the list of choices, or both.
std::string values_of(const Parameter& parameter);

/// The resolved values of all settings in a preset.
Settings settings_of(const Traversal& traversal, const Preset& preset);

/// "device in resident; sphere in published": the values of a setting by preset. The initial value is added
/// when no preset has it. Empty when no preset changes the setting.
std::string by_preset(const Traversal& traversal, const Parameter& parameter);

/// "range" or "choices", the name of values_of().
std::string_view kind_of_values(const Parameter& parameter);

} // namespace tandem
