// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

namespace tandem {

/// The value of a scene parameter; throws InputError that names the allowed range.
double real_parameter(std::span<const SceneParameter> parameters, std::string_view name, double least,
                      double most);
std::uint64_t integer_parameter(std::span<const SceneParameter> parameters, std::string_view name,
                                std::uint64_t least, std::uint64_t most);
const std::string& text_parameter(std::span<const SceneParameter> parameters, std::string_view name);

/// "NAME:par=value,..." of a scene kind and its parameters.
std::string key_of(std::string_view name, std::span<const SceneParameter> parameters);

/// The kinds of scene, one function each.
SceneKind plates_kind();
SceneKind pile_kind();

/// Scene description in JSON (scenes/scene.schema.json); mesh files are found relative to it.
Scene load_description(const std::string& path);

} // namespace tandem
