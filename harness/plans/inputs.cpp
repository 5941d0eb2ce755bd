// SPDX-License-Identifier: MIT
#include "harness/plans/inputs.h"

#include "algorithms/bodies/range.h"
#include "base/error.h"
#include "base/quaternion.h"
#include "base/standard_streams.h"
#include "harness/plans/device_models.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>
#include <sstream>

namespace tandem {

namespace {

/// Parses "tx ty tz qw qx qy qz".
Pose parse_pose(const std::string& text) {
    std::istringstream in(text);
    std::array<double, 7> v{};
    for (auto& value : v) in >> value;
    std::string rest;
    const auto rotation = given_rotation(v[3], v[4], v[5], v[6]);
    if (!in || in >> rest || !rotation)
        throw InputError(fmt::format(
            "--pose '{}': give seven numbers \"tx ty tz qw qx qy qz\" with a quaternion that is finite "
            "and not 0",
            text));
    return {*rotation, Eigen::Vector3d(v[0], v[1], v[2])};
}

/// Parses one number of `whole`, the text of the option, which the error message quotes.
std::size_t parse_number(std::string_view text, const std::string& whole) {
    std::size_t value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc{} || result.ptr != text.data() + text.size())
        throw InputError(fmt::format("--frames {}: give FIRST:LAST, both inclusive, or one number", whole));
    return value;
}

/// A path through links; the path itself where that cannot be found, as for a pipe.
std::filesystem::path followed(const std::filesystem::path& path) {
    std::error_code code;
    const auto found = std::filesystem::weakly_canonical(path, code);
    return code ? path.lexically_normal() : found;
}

} // namespace

void report_findings(const Scene& scene) {
    std::set<std::pair<std::string, std::string>> found; // several bodies may read the same file
    for (const auto& mesh : scene.meshes)
        if (const auto text = findings_text(mesh); !text.empty()) found.emplace(mesh.name, text);
    for (const auto& [name, text] : found) print_message("tandem: mesh {}: {}\n", name, text);
}

Scene open_scene(const RunOptions& options) {
    if (options.meshes.empty()) {
        if (options.scene.empty())
            throw InputError("no scene; name one (see 'tandem scenes') or give --mesh FILE");
        if (!options.poses.empty()) throw InputError("--pose requires --mesh; a scene has its own poses");
        return make_scene(options.scene, options.reading);
    }
    if (!options.scene.empty() || options.scenes.size() > 1)
        throw InputError("a scene and --mesh exclude each other; leave one out");
    if (options.poses.size() > options.meshes.size())
        throw InputError("more --pose than --mesh; give at most one pose for each mesh");
    std::vector<Pose> poses;
    for (const auto& text : options.poses) poses.push_back(parse_pose(text));
    return scene_from_meshes(options.meshes, poses, options.reading);
}

FrameRange open_frames(const RunOptions& options, const Scene& scene, bool bounds_motion) {
    const auto [first, last] = named_frames(options.frames, scene, bounds_motion);
    return {scene, first, last, options.degenerate, frame_budget, bounds_motion};
}

bool bounds_motion(std::span<const Cell> cells) {
    return std::ranges::any_of(cells, [](const Cell& cell) {
        return geometry_of(cell.settings).motion == Motion::linear || bounds_motion(cell.candidates);
    });
}

std::pair<std::size_t, std::size_t> named_frames(const std::string& frames, const Scene& scene,
                                                 bool bounds_motion) {
    const bool leaves_out_last = bounds_motion && scene.frame_count > 1;
    if (frames.empty()) return {0, scene.frame_count - (leaves_out_last ? 2 : 1)};
    const auto colon = frames.find(':');
    const auto text = std::string_view(frames);
    const auto first = parse_number(text.substr(0, colon), frames);
    const auto last = colon == std::string::npos ? first : parse_number(text.substr(colon + 1), frames);
    check_frames(scene, first, last);
    return {first, last};
}

std::vector<BackendReport> open_named(std::span<const std::string> names,
                                      const std::vector<std::string>& require) {
    auto backends = open_backends(names, require);
    check_required(backends, require);
    if (std::ranges::find(names, default_device) != names.end()) {
        const auto& info = default_of(backends)->info();
        put("device {}: {}, {}--device chooses another)\n", info.id, model_name(info),
            info.is_gpu ? "the first GPU (" : "because there is no GPU ('tandem devices' says why; ");
    }
    return backends;
}

std::vector<DeviceGroup> open_devices(const RunOptions& options, const std::vector<BackendReport>& backends,
                                      std::span<const std::string> names) {
    limit_memory(options, backends);
    return choose_devices(backends, names);
}

void limit_memory(const RunOptions& options, const std::vector<BackendReport>& backends) {
    if (options.memory == 0) return;
    for (const auto& backend : backends)
        for (const auto& device : backend.devices) device->set_memory_limit(options.memory);
}

void check_required(const std::vector<BackendReport>& backends, const std::vector<std::string>& require) {
    std::vector<std::string> available;
    for (const auto& backend : backends)
        for (const auto& device : backend.devices) available.push_back(device->info().id);
    for (const auto& name : require) {
        if (is_available(name, backends)) continue;
        const auto backend = std::find_if(backends.begin(), backends.end(),
                                          [&](const auto& report) { return report.name == name; });
        const auto reason = backend != backends.end() ? backend->reason : "no such backend or device";
        throw InputError(
            fmt::format("--require {}: {} (there are: {})", name, reason, fmt::join(available, ", ")));
    }
}

void check_coordinates(const Cell& cell, const Scene& scene, const Frame& frame) {
    check_range(scene, frame, geometry_of(cell.settings));
}

void check_coordinates(const Cell& cell, const Scene& scene, const FrameRange& range) {
    const auto last = range.size() + (range.has_successor() ? 1 : 0);
    for (std::size_t i = 0; i < last; ++i) check_coordinates(cell, scene, *range.frame(i));
}

namespace {

/// Throws InputError where an option asks for contacts or distances that the cell's rule does not make.
void check_rule_outputs(const RunOptions& options, const Settings& settings) {
    const auto rule = settings[parameters::contact_rule];
    if (!options.dump_contacts.empty() && rule == ContactRule::none)
        throw InputError("--dump-contacts needs contacts; leave contact_rule out");
    if (!options.dump_contacts.empty() && has_near_pairs(rule))
        throw InputError(fmt::format("contact_rule={} makes distances; use --dump-distances",
                                     settings.text("contact_rule")));
    if (!options.dump_distances.empty() && !has_near_pairs(rule))
        throw InputError("--dump-distances needs contact_rule=distance; set it, or use --dump-contacts");
    if (options.dump_surfaces.empty()) return;
    if (!needs_pressures(rule) || settings[parameters::output] == Output::wrenches)
        throw InputError(
            "--dump-surfaces needs contact_rule=pressure, and no output=wrenches; set the rule, or "
            "use --dump-contacts");
    if (geometry_of(settings).placement == Placement::exact)
        throw InputError("--dump-surfaces takes rounded vertices, which placement=exact does not have; leave "
                         "placement out");
}

/// The same for what the cell's output leaves out.
void check_cell_outputs(const RunOptions& options, const Cell& cell) {
    const auto& settings = cell.settings;
    if (options.has_dumps() && !has_pairs(settings[parameters::output]))
        throw InputError("dumps need pairs; leave output out or set output=pairs");
    const auto output = settings.text("output");
    const bool leaves_out = leaves_out_pairs(settings[parameters::output]);
    if (leaves_out && !options.dump_pairs.empty())
        throw InputError(
            fmt::format("--dump-pairs needs all candidate pairs, and output={} may leave some out; "
                        "set output=pairs",
                        output));
    if (leaves_out && options.truth_is_given && options.truth == TruthAmount::pairs)
        throw InputError(
            fmt::format("--truth pairs needs all candidate pairs, and output={} may leave some out; "
                        "set output=pairs, or choose --truth contacts",
                        output));
    check_rule_outputs(options, settings);
}

} // namespace

void check_outputs(const RunOptions& options, std::span<const Cell> cells) {
    std::set<std::filesystem::path> paths;
    for (const auto* path : {&options.out, &options.dump_pairs, &options.dump_contacts,
                             &options.dump_distances, &options.dump_surfaces, &options.trace})
        if (!path->empty() && !paths.insert(followed(*path)).second)
            throw InputError(fmt::format("{}: named for two outputs; choose another file", *path));
    const bool dumps = options.has_dumps();
    if (options.profile > 0 && (dumps || !options.out.empty() || !options.trace.empty()))
        throw InputError("--profile only replays frames; leave out --out, --trace and dumps");
    for (const auto& cell : cells) check_cell_outputs(options, cell);
}

} // namespace tandem
