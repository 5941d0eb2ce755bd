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

/// "NAME:par=value,..." of a scene kind and its parameters. See SceneParameter::left_out.
std::string key_of(std::string_view name, std::span<const SceneParameter> parameters);

// The kinds of scene, one word each, in the order of listings: scenes/kinds/WORD.cpp defines WORD_kind().
// clang-format off
#define TANDEM_SCENE_KINDS(KIND) \
    KIND(plates) \
    KIND(pile) \
    KIND(glasses) \
    KIND(funnel) \
    KIND(colosseum) \
    KIND(tower) \
    KIND(meteor) \
    KIND(jacks) \
    KIND(chalk) \
    KIND(temple) \
    KIND(arch) \
    KIND(block) \
    KIND(rod) \
    KIND(sheet) \
    KIND(column) \
    KIND(spheres) \
    KIND(grippers)
// clang-format on
#define TANDEM_DECLARE_KIND(name) SceneKind name##_kind();
TANDEM_SCENE_KINDS(TANDEM_DECLARE_KIND)
#undef TANDEM_DECLARE_KIND

/// Reads a scene description in JSON (scenes/scene.schema.json); paths of mesh files are relative to it.
Scene load_description(const std::string& path, const MeshReading& reading = {});

} // namespace tandem
