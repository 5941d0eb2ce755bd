// SPDX-License-Identifier: MIT
#include "python/core/scenes.h"

#include "python/core/arrays.h"
#include "scenes/scene.h"

#include <fmt/format.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace tandem::python {

namespace {

/// `number`: an integer from 0 on, and no bool, which is one in Python.
Frame frame_of(const Scene& scene, nb::handle number) {
    std::size_t index = 0;
    if (PyBool_Check(number.ptr()) != 0 || !nb::try_cast(number, index))
        throw nb::type_error(fmt::format("frame: type {}; expected the number of a frame, from 0 on",
                                         nb::type_name(number.type()).c_str())
                                 .c_str());
    if (index >= scene.frame_count)
        throw nb::index_error(
            fmt::format("frame {} of {}; frames are numbered from 0", index, scene.frame_count).c_str());
    return scene.frame(index);
}

auto poses_of(const Scene& scene, nb::handle number) {
    const auto frame = frame_of(scene, number);
    std::vector<double> rows;
    for (const auto& [q, t] : frame.poses)
        rows.insert(rows.end(), {t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()});
    return owned_array<double, 7>(std::move(rows));
}

nb::dict vertices_of(const Scene& scene, nb::handle number) {
    auto frame = frame_of(scene, number);
    nb::dict all;
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        if (scene.bodies[body].deformable)
            all[nb::int_(body)] = owned_array<double, 3>(std::move(frame.deformed[body]));
    return all;
}

std::vector<std::uint32_t> meshes_of_bodies(const Scene& scene) {
    std::vector<std::uint32_t> meshes;
    for (const auto& body : scene.bodies) meshes.push_back(body.mesh);
    return meshes;
}

std::vector<std::size_t> deformable_bodies(const Scene& scene) {
    std::vector<std::size_t> bodies;
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        if (scene.bodies[body].deformable) bodies.push_back(body);
    return bodies;
}

} // namespace

void bind_scenes(nb::module_& module) {
    nb::class_<Scene>(
        module, "Scene",
        "Meshes, bodies and their motion, for a Collider to run frame by frame. meshes: a "
        "list of Mesh; bodies: the number of each body's mesh; deformable: numbers of the bodies "
        "with new vertices in every frame; frame_count: number of frames; key: name and parameters.")
        .def("__repr__",
             [](const Scene& self) {
                 return fmt::format("<tandem.Scene {}: {} bodies, {} frames>", self.key, self.bodies.size(),
                                    self.frame_count);
             })
        .def_ro("key", &Scene::key)
        .def_ro("frame_count", &Scene::frame_count)
        .def_ro("meshes", &Scene::meshes)
        .def_prop_ro("bodies", &meshes_of_bodies)
        .def_prop_ro("deformable", &deformable_bodies)
        .def("poses", &poses_of, nb::arg("frame"),
             nb::sig(
                 "def poses(self, frame: int) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 7))]"),
             "Poses of a frame, numbered from 0: (bodies, 7) float64, rows tx ty tz qw qx qy qz.")
        .def("vertices", &vertices_of, nb::arg("frame"), nb::sig("def vertices(self, frame: int) -> dict"),
             "Vertices of a frame's deformable bodies: {body: (n, 3) float64}, in world coordinates.");
    module.def(
        "make_scene",
        [](const std::string& specification, const MeshReading& reading) {
            return make_scene(specification, reading);
        },
        nb::arg("specification"), nb::arg("reading"), nb::call_guard<nb::gil_scoped_release>(),
        "Implementation of tandem.make_scene, which checks its input.");
}

} // namespace tandem::python
