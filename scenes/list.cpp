// SPDX-License-Identifier: MIT
#include "scenes/digest.h"
#include "base/error.h"
#include "scenes/hard/hard.h"
#include "scenes/parameters.h"
#include "scenes/recording/recording.h"
#include "scenes/refine.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fmt/format.h>

namespace tandem {

namespace {

const SceneParameter& parameter(std::span<const SceneParameter> parameters, std::string_view name) {
    return *std::find_if(parameters.begin(), parameters.end(), [&](const auto& p) { return p.name == name; });
}

template<class Number>
Number number(const SceneParameter& p, Number least, Number most) {
    Number value{};
    const auto* end = p.value.data() + p.value.size();
    const auto result = std::from_chars(p.value.data(), end, value);
    if (result.ec != std::errc{} || result.ptr != end || !(value >= least && value <= most))
        throw InputError(fmt::format("scene parameter {}={} is impossible; give a number from {} to {}",
                                     p.name, p.value, least, most));
    return value;
}

/// Removes redundant digits of a number (0.20 becomes 0.2), so that equal scenes have equal keys.
std::string canonical(std::string_view value) {
    double number = 0;
    const auto* end = value.data() + value.size();
    const auto result = std::from_chars(value.data(), end, number);
    const bool plain = value.find_first_of(".eE") == std::string_view::npos;
    if (plain || result.ec != std::errc{} || result.ptr != end) return std::string(value);
    return fmt::format("{}", number);
}

/// The kind's parameters with their defaults replaced by "par=value,par=value".
std::vector<SceneParameter> with_values(const SceneKind& kind, std::string_view text) {
    auto parameters = kind.parameters;
    std::vector<std::string> names;
    names.reserve(parameters.size());
    for (const auto& p : parameters) names.push_back(p.name);
    std::vector<bool> given(names.size());
    while (!text.empty()) {
        const auto item = text.substr(0, text.find(','));
        text.remove_prefix(std::min(text.size(), item.size() + 1));
        const auto equals = item.find('=');
        const auto name = item.substr(0, equals);
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
            throw InputError(unknown(fmt::format("parameter of scene {}", kind.name), name, names));
        if (equals == std::string_view::npos)
            throw InputError(fmt::format("scene parameter {} has no value; write {}=VALUE", name, name));
        const auto index = static_cast<std::size_t>(found - names.begin());
        if (given[index])
            throw InputError(fmt::format("scene parameter {} is given twice; leave one out", name));
        given[index] = true;
        parameters[index].value = canonical(item.substr(equals + 1));
    }
    return parameters;
}

/// Throws for files of other kinds than scenes, by their suffix.
void refuse_other_files(std::string_view specification) {
    const std::filesystem::path path(specification);
    const auto suffix = path.extension().string();
    if (suffix == ".jsonl")
        throw InputError(
            fmt::format("{} is a file of records, not a scene; 'tandem report' draws it", specification));
    for (const auto* mesh : {".msh", ".mesh", ".vtk", ".vtu", ".node", ".ele"})
        if (suffix == mesh)
            throw InputError(fmt::format("{} is a mesh, not a scene; give it with --mesh {}", specification,
                                         specification));
    for (const auto* surface : {".stl", ".obj", ".ply", ".off"})
        if (suffix == surface)
            throw InputError(fmt::format("{} is a surface, and tandem needs tetrahedra; make them with Gmsh, "
                                         "fTetWild or TetGen, and give the mesh with --mesh",
                                         specification));
}

/// Connects the meshes of a kind anew, where that may differ from how the kind connects them, and gives them
/// fields.
void connect(Scene& scene, const MeshReading& reading) {
    if (reading.duplicates == Duplicates::merge && !reading.weld && !reading.pressure) return;
    for (auto& mesh : scene.meshes) complete_mesh(mesh, mesh.name, reading);
}

} // namespace

std::span<const SceneKind> scene_kinds() {
#define TANDEM_KIND(name) name##_kind(),
    static const std::vector<SceneKind> kinds{TANDEM_SCENE_KINDS(TANDEM_KIND)};
#undef TANDEM_KIND
    return kinds;
}

Scene make_scene(std::string_view specification, const MeshReading& reading) {
    refuse_other_files(specification);
    if (specification.ends_with(".json")) return load_description(std::string(specification), reading);
    if (specification.ends_with(".frames")) return load_recording(std::string(specification), reading);
    const bool hard = specification.starts_with("hard:");
    const auto name = specification.substr(0, specification.find(':', hard ? 5 : 0));
    if (hard) hard_family(name.substr(5));
    std::vector<std::string> names;
    for (const auto& kind : hard ? hard_kinds() : scene_kinds()) {
        names.push_back(kind.name);
        if (kind.name != name) continue;
        const auto rest =
            name.size() < specification.size() ? specification.substr(name.size() + 1) : std::string_view();
        if (reading.corners || reading.only_tetrahedra)
            throw InputError(
                fmt::format("--corners and --only-tetrahedra do not go with scene {}; give --mesh FILE or a "
                            "scene description",
                            kind.name));
        const auto parameters = with_values(kind, rest);
        auto scene = kind.make(parameters);
        scene.name = kind.name;
        scene.key = key_of(kind.name, parameters);
        scene.reading = reading;
        connect(scene, reading);
        scene.digest = digest_of(scene);
        return scene;
    }
    names.emplace_back("hard:FAMILY");
    throw InputError(unknown("scene", name, names));
}

double real_parameter(std::span<const SceneParameter> parameters, std::string_view name, double least,
                      double most) {
    return number<double>(parameter(parameters, name), least, most);
}

std::uint64_t integer_parameter(std::span<const SceneParameter> parameters, std::string_view name,
                                std::uint64_t least, std::uint64_t most) {
    return number<std::uint64_t>(parameter(parameters, name), least, most);
}

const std::string& text_parameter(std::span<const SceneParameter> parameters, std::string_view name) {
    return parameter(parameters, name).value;
}

SceneParameter refine_parameter() {
    return {"refine", "0",
            fmt::format("levels of refinement, each replaces a tetrahedron by eight, 0..{}", most_refinement),
            "0"};
}

std::uint64_t refine_value(std::span<const SceneParameter> parameters) {
    return integer_parameter(parameters, "refine", 0, most_refinement);
}

std::string key_of(std::string_view name, std::span<const SceneParameter> parameters) {
    std::string key(name);
    for (const auto& p : parameters) {
        if (!p.left_out.empty()
            && p.value.substr(std::min(p.value.find_first_not_of('0'), p.value.size() - 1)) == p.left_out)
            continue; // also with zeros before it
        key += fmt::format("{}{}={}", key.size() == name.size() ? ':' : ',', p.name, p.value);
    }
    return key;
}

std::size_t vertex_count(const Scene& scene) {
    std::size_t count = 0;
    for (const auto& body : scene.bodies) count += scene.meshes[body.mesh].vertices.size();
    return count;
}

std::size_t tetrahedron_count(const Scene& scene) {
    std::size_t count = 0;
    for (const auto& body : scene.bodies) count += scene.meshes[body.mesh].tetrahedra.size();
    return count;
}

} // namespace tandem
