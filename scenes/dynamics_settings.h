// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/dynamics.h"

#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace tandem {

/// A setting of a simulation that is set by name in any scene.
struct DynamicsSetting {
    enum class Kind { real, whole, toggle, word };
    std::string_view name, help;
    Kind kind;
    double least, most;             ///< range of a number
    std::vector<std::string> words; ///< allowed values of a word
    std::function<std::string(const Dynamics&)> value;
    std::function<void(Dynamics&, std::string_view text)> set; ///< throws InputError
};

std::span<const DynamicsSetting> dynamics_settings();

/// A named set of values.
struct DynamicsPreset {
    std::string_view name, help;
    std::vector<std::string_view> assignments; ///< "NAME=VALUE"
};

std::span<const DynamicsPreset> dynamics_presets();

/// Applies "NAME=VALUE", or all values of a preset's name, to `dynamics`. Throws InputError with the nearest
/// name or the allowed values.
void set_dynamics(Dynamics& dynamics, std::string_view assignment);

/// All settings as "step=0.01,method=gauss_seidel,..."; equal texts give equal motion.
std::string describe(const Dynamics& dynamics);

} // namespace tandem
