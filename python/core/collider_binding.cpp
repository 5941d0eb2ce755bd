// SPDX-License-Identifier: MIT
// Collider as Python has it: what arrays become on their way in, and where the interpreter's lock is let go.
#include "python/core/answer.h"
#include "python/core/collider.h"
#include "python/core/plain_input.h"

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
                               std::string device, SettingTexts settings,
                               std::optional<std::uintptr_t> stream, nb::object owner) {
    const nb::gil_scoped_release released;
    std::vector<Mesh> copies;
    for (const auto* mesh : meshes) copies.push_back(*mesh);
    auto collider = std::make_shared<Collider>(
        std::move(copies),
        ColliderOptions{std::move(bodies), std::move(deformable), std::move(algorithm), std::move(preset),
                        std::move(device), std::move(settings), stream});
    collider->keep(std::move(owner));
    return collider;
}

HostInput host_input(const std::optional<Poses>& poses, const std::vector<std::optional<Points>>& vertices) {
    HostInput input;
    if (poses) input.poses = rows_of(*poses);
    for (const auto& rows : vertices)
        input.vertices.push_back(rows ? std::optional(rows_of(*rows)) : std::nullopt);
    return input;
}

/// Of arrays as given_rows takes them, one a body.
MixedInput mixed_input(const Collider& collider, nb::handle poses, const nb::list& vertices) {
    const auto& device = *collider.devices().front();
    MixedInput input{given_rows(poses, 7, "poses", device), {}};
    for (std::size_t body = 0; body < vertices.size(); ++body)
        input.vertices.push_back(
            given_rows(vertices[body], 3, fmt::format("vertices of body {}", body), device));
    return input;
}

template<class Input>
std::unique_ptr<Answer> run(const std::shared_ptr<Collider>& collider, const Input& input) {
    const nb::gil_scoped_release released;
    auto [result, seconds] = collider->run(input);
    return std::make_unique<Answer>(collider, std::move(result), seconds);
}

/// A tuple (algorithm, changed settings, seconds) a trial, the fastest first.
template<class Input>
nb::list tune(Collider& collider, const Input& input, double seconds) {
    const auto trials = [&] {
        const nb::gil_scoped_release released;
        return collider.tune(input, seconds);
    }();
    nb::list all;
    for (const auto& trial : trials)
        all.append(nb::make_tuple(trial.algorithm, trial.changes, trial.seconds));
    return all;
}

/// What producers of arrays are told (DLPack), which have another name for the default stream.
std::uintptr_t queue(const Collider& collider) {
    return reinterpret_cast<std::uintptr_t>(collider.devices().front()->queue());
}

/// Number of the CUDA device that the collider works on; none where it works elsewhere, or on several.
std::optional<int> cuda_device(const Collider& collider) {
    if (collider.devices().size() != 1) return std::nullopt;
    const auto there = dlpack_device(*collider.devices().front());
    return there && there->first == nb::device::cuda::value ? std::optional(there->second) : std::nullopt;
}

} // namespace

void bind_collider(nb::module_& module) {
    module.def("algorithms", &algorithm_names, "Names that Collider takes as its algorithm, beside auto.");
    const auto released = nb::call_guard<nb::gil_scoped_release>();
    const auto run_here = [](const std::shared_ptr<Collider>& self, const std::optional<Poses>& poses,
                             const std::vector<std::optional<Points>>& vertices) {
        return run(self, host_input(poses, vertices));
    };
    const auto run_there = [](const std::shared_ptr<Collider>& self, nb::handle poses,
                              const nb::list& vertices) {
        return run(self, mixed_input(*self, poses, vertices));
    };
    const auto tune_here = [](Collider& self, const std::optional<Poses>& poses,
                              const std::vector<std::optional<Points>>& vertices,
                              double seconds) { return tune(self, host_input(poses, vertices), seconds); };
    const auto tune_there = [](Collider& self, nb::handle poses, const nb::list& vertices, double seconds) {
        return tune(self, mixed_input(self, poses, vertices), seconds);
    };
    const auto run_plain = [](const std::shared_ptr<Collider>& self, nb::handle poses,
                              nb::handle vertices) -> std::unique_ptr<Answer> {
        PlainInput plain;
        return plain.hold(*self, poses, vertices) ? run(self, plain.input()) : nullptr;
    };
    nb::class_<Collider>(module, "Collider", "What tandem.Collider, which checks its input, hands it to.")
        .def(nb::new_(&make), nb::arg("meshes"), nb::arg("bodies"), nb::arg("deformable"),
             nb::arg("algorithm"), nb::arg("preset"), nb::arg("device"), nb::arg("settings"),
             nb::arg("stream").none(), nb::arg("owner").none())
        .def("run", run_here, nb::arg("poses").none(), nb::arg("vertices"))
        .def("run_plain", run_plain, nb::arg("poses").none(), nb::arg("vertices").none(),
             nb::sig("def run_plain(self, poses: object | None, vertices: object | None) -> Answer | None"),
             "The same of what is as it has to be already: float64 with rows beside each other by the buffer "
             "protocol, in a list or a dict. None where anything is something else.")
        .def("run_there", run_there, nb::arg("poses").none(), nb::arg("vertices"),
             "The same of arrays some of which are in memory of the device: capsules of DLPack, or (address, "
             "rows, bits, stream) of __cuda_array_interface__.")
        .def("tune", tune_here, nb::arg("poses").none(), nb::arg("vertices"), nb::arg("seconds"))
        .def("tune_there", tune_there, nb::arg("poses").none(), nb::arg("vertices"), nb::arg("seconds"))
        .def("reset", &Collider::reset, released)
        .def_prop_ro("algorithm", &Collider::algorithm, released)
        .def_prop_ro("settings", &Collider::setting_texts, released)
        .def_prop_ro("devices", &device_names)
        .def_prop_ro("queue", &queue)
        .def_prop_ro("cuda_device", &cuda_device)
        .def_prop_ro("addresses", &Collider::addresses, released,
                     "Where kernels read the last frame of run_there: poses, 0 for none, then vertices of "
                     "each deformable body.");
}

} // namespace tandem::python
