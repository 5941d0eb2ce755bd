// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

namespace tandem {

/// The value of a scene parameter. Throws InputError with the allowed range.
double real_parameter(std::span<const SceneParameter> parameters, std::string_view name, double least,
                      double most);
std::uint64_t integer_parameter(std::span<const SceneParameter> parameters, std::string_view name,
                                std::uint64_t least, std::uint64_t most);
const std::string& text_parameter(std::span<const SceneParameter> parameters, std::string_view name);

/// The parameter `refine`: levels of uniform refinement (scenes/refine.h).
SceneParameter refine_parameter();
std::uint64_t refine_value(std::span<const SceneParameter> parameters);

/// "NAME:par=value,..." of a scene kind and its parameters. refine=0 is left out, so that keys equal those of
/// records without this parameter.
std::string key_of(std::string_view name, std::span<const SceneParameter> parameters);

/// The kinds of scene, one function each.
SceneKind plates_kind();
SceneKind pile_kind();
SceneKind glasses_kind();
SceneKind funnel_kind();
SceneKind colosseum_kind();
SceneKind tower_kind();
SceneKind meteor_kind();
SceneKind jacks_kind();
SceneKind chalk_kind();
SceneKind temple_kind();
SceneKind arch_kind();
SceneKind block_kind();

/// Reads a scene description in JSON (scenes/scene.schema.json); paths of mesh files are relative to it.
Scene load_description(const std::string& path);

} // namespace tandem
