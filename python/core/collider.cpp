// SPDX-License-Identifier: MIT
#include "python/core/collider.h"

#include "algorithms/bodies/range.h"
#include "python/core/answer.h"
#include "scenes/error.h"

#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace tandem::python {

namespace {

/// Every body at the identity, deformable ones with their mesh's vertices.
Frame rest(const Scene& scene) {
    Frame frame{std::vector<Pose>(scene.bodies.size()),
                std::vector<std::vector<Eigen::Vector3d>>(scene.bodies.size())};
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        if (scene.bodies[body].deformable)
            frame.deformed[body] = scene.meshes[scene.bodies[body].mesh].vertices;
    return frame;
}

Scene scene_of(std::vector<Mesh> meshes, const ColliderOptions& options) {
    Scene scene;
    scene.name = scene.key = "meshes";
    scene.meshes = std::move(meshes);
    for (std::size_t body = 0; body < options.bodies.size(); ++body) {
        const auto mesh = options.bodies[body];
        if (mesh >= scene.meshes.size())
            throw InputError(fmt::format("bodies: body {} is of mesh {} of {}; meshes are numbered from 0",
                                         body, mesh, scene.meshes.size()));
        scene.bodies.push_back({.mesh = mesh, .fixed = false, .deformable = options.deformable[body]});
    }
    return scene;
}

Settings settings_of(const Traversal& traversal, const ColliderOptions& options) {
    const auto& chosen =
        options.preset.empty() ? traversal.presets().front() : preset(traversal, options.preset);
    return resolve(traversal.parameters(), chosen.values, options.settings, traversal.name());
}

/// As --pose: the bounds on the squared norm keep normalising clear of overflow and of 0 / 0.
Pose pose_of(const double* row, std::size_t body) {
    const Eigen::Quaterniond rotation(row[3], row[4], row[5], row[6]);
    const double norm = rotation.squaredNorm();
    if (!(norm > 1e-300 && norm < 1e300))
        throw InputError(fmt::format("poses: row {} has no rotation; give tx ty tz qw qx qy qz with a "
                                     "quaternion that is finite and not 0",
                                     body));
    const Eigen::Vector3d translation(row[0], row[1], row[2]);
    if (!translation.allFinite())
        throw InputError(fmt::format("poses: row {} is not finite; give tx ty tz qw qx qy qz", body));
    return {rotation.normalized(), translation};
}

} // namespace

Collider::Collider(std::vector<Mesh> meshes, const ColliderOptions& options) {
    const auto& traversal = tandem::algorithm(options.algorithm);
    const auto resolved = settings_of(traversal, options);
    const std::vector<std::string> names{options.device};
    backends_ = open_backends(names, {});
    auto groups = choose_devices(backends_, names);
    if (groups.size() != 1)
        throw InputError("device=all names several; give one, or several that share the work as D+E");
    devices_ = std::move(groups.front());
    scene_ = scene_of(std::move(meshes), options);
    scene_.frame = [this](std::size_t) { return rest(scene_); };
    frame_ = rest(scene_);
    check_range(scene_, frame_, geometry_of(resolved).precision);
    session_ = traversal.prepare(devices_, scene_, resolved);
}

std::pair<FrameResult, double> Collider::run(const std::optional<Poses>& poses,
                                             const std::vector<std::optional<Points>>& vertices) {
    const std::lock_guard lock(mutex_);
    if (poses)
        set_poses(*poses);
    else
        std::ranges::fill(frame_.poses, Pose{});
    for (std::size_t body = 0; body < bodies(); ++body) {
        if (!scene_.bodies[body].deformable) continue;
        if (body < vertices.size() && vertices[body])
            set_vertices(body, *vertices[body]);
        else
            frame_.deformed[body] = scene_.meshes[scene_.bodies[body].mesh].vertices;
    }
    check_coordinates();
    const auto begin = std::chrono::steady_clock::now();
    auto result = session_->run(frame_);
    return {std::move(result),
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
}

void Collider::reset() {
    const std::lock_guard lock(mutex_);
    session_->reset();
}

void Collider::set_poses(const Poses& poses) {
    if (poses.shape(0) != bodies())
        throw InputError(
            fmt::format("poses: {} rows for {} bodies; give each body its row", poses.shape(0), bodies()));
    for (std::size_t body = 0; body < bodies(); ++body)
        frame_.poses[body] = scene_.bodies[body].deformable ? Pose{} : pose_of(poses.data() + 7 * body, body);
}

void Collider::set_vertices(std::size_t body, const Points& vertices) {
    const auto count = scene_.meshes[scene_.bodies[body].mesh].vertices.size();
    if (vertices.shape(0) != count)
        throw InputError(fmt::format("vertices: {} rows for body {}, whose mesh has {} vertices",
                                     vertices.shape(0), body, count));
    copy_points(vertices, frame_.deformed[body]);
}

/// Meshes were looked at once; the library's own check, which looks at them again, has the sentence.
void Collider::check_coordinates() const {
    const auto precision = geometry_of(session_->settings()).precision;
    const double limit = largest_coordinate(precision);
    std::size_t beyond = 0; // counted, not looked for: a loop of vector code
    for (const auto& pose : frame_.poses)
        for (const double x : pose.translation) beyond += !(std::abs(x) <= limit);
    for (const auto& points : frame_.deformed) {
        const auto* const numbers = reinterpret_cast<const double*>(points.data());
        for (std::size_t i = 0; i < 3 * points.size(); ++i) beyond += !(std::abs(numbers[i]) <= limit);
    }
    if (beyond > 0) check_range(scene_, frame_, precision);
}

namespace {

std::vector<std::string> algorithm_names() {
    std::vector<std::string> names;
    for (const auto* traversal : algorithms()) names.emplace_back(traversal->name());
    return names;
}

std::vector<std::string> device_names(const Collider& collider) {
    std::vector<std::string> names;
    for (const auto* device : collider.devices()) names.push_back(device->info().id);
    return names;
}

std::shared_ptr<Collider> make(const std::vector<const Mesh*>& meshes, std::vector<std::uint32_t> bodies,
                               std::vector<bool> deformable, std::string algorithm, std::string preset,
                               std::string device, SettingTexts settings) {
    const nb::gil_scoped_release released;
    std::vector<Mesh> copies;
    for (const auto* mesh : meshes) copies.push_back(*mesh);
    return std::make_shared<Collider>(
        std::move(copies), ColliderOptions{std::move(bodies), std::move(deformable), std::move(algorithm),
                                           std::move(preset), std::move(device), std::move(settings)});
}

std::unique_ptr<Answer> run(const std::shared_ptr<Collider>& collider, const std::optional<Poses>& poses,
                            const std::vector<std::optional<Points>>& vertices) {
    const nb::gil_scoped_release released;
    auto [result, seconds] = collider->run(poses, vertices);
    return std::make_unique<Answer>(collider, std::move(result), seconds);
}

} // namespace

void bind_collider(nb::module_& module) {
    module.def("algorithms", &algorithm_names, "Names that Collider takes as its algorithm.");
    nb::class_<Collider>(module, "Collider", "What tandem.Collider, which checks its input, hands it to.")
        .def(nb::new_(&make), nb::arg("meshes"), nb::arg("bodies"), nb::arg("deformable"),
             nb::arg("algorithm"), nb::arg("preset"), nb::arg("device"), nb::arg("settings"))
        .def("run", &run, nb::arg("poses").none(), nb::arg("vertices"))
        .def("reset", &Collider::reset, nb::call_guard<nb::gil_scoped_release>())
        .def_prop_ro("settings", [](const Collider& self) { return self.settings().texts(); })
        .def_prop_ro("devices", &device_names);
}

} // namespace tandem::python
