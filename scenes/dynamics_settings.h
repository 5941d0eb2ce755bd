// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/dynamics.h"

#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace tandem {

/// A setting of a simulation that can be given by name, whatever the scene.
struct DynamicsSetting {
    enum class Kind { real, whole, toggle, word };
    std::string_view name, help;
    Kind kind;
    double least, most;             ///< of a number
    std::vector<std::string> words; ///< of a word
    std::function<std::string(const Dynamics&)> value;
    std::function<void(Dynamics&, std::string_view text)> set; ///< throws InputError
};

std::span<const DynamicsSetting> dynamics_settings();

/// Writes "NAME=VALUE" over `dynamics`; throws InputError that names the nearest name or the allowed values.
void set_dynamics(Dynamics& dynamics, std::string_view assignment);

/// "step=0.01,method=gauss_seidel,..." of every setting: equal texts, equal motion.
std::string describe(const Dynamics& dynamics);

} // namespace tandem
