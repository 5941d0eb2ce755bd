// SPDX-License-Identifier: MIT
// Python binding of Collider. Releases the interpreter's lock around work on devices.
#include "python/core/answer.h"
#include "python/core/collider.h"
#include "python/core/input.h"
#include "python/core/queued.h"

#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
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

std::shared_ptr<Collider> make(const std::vector<const Mesh*>& meshes, const ColliderOptions& options,
                               nb::object owner) {
    const nb::gil_scoped_release released;
    std::vector<Mesh> copies;
    for (const auto* mesh : meshes) copies.push_back(*mesh);
    auto collider = std::make_shared<Collider>(std::move(copies), options);
    collider->set_stream_owner(std::move(owner));
    return collider;
}

std::unique_ptr<Answer> run(const std::shared_ptr<Collider>& collider, const Input& input) {
    const nb::gil_scoped_release released;
    return std::make_unique<Answer>(collider, collider->run(input));
}

/// One tuple (algorithm, changed settings, seconds) per trial, the fastest first. None where input_of returns
/// none.
std::optional<nb::list> tune(Collider& collider, nb::handle poses, nb::handle vertices, double seconds,
                             nb::handle next_poses, nb::handle next_vertices) {
    const auto input = input_of(collider, {poses, vertices}, {next_poses, next_vertices});
    if (!input) return std::nullopt;
    const auto trials = [&] {
        const nb::gil_scoped_release released;
        return collider.tune(*input, seconds);
    }();
    nb::list all;
    for (const auto& trial : trials)
        all.append(nb::make_tuple(trial.algorithm, trial.changes, trial.seconds));
    return all;
}

using BodyPairNumbers = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::vector<BodyPair> body_pairs_of(const BodyPairNumbers& numbers) {
    std::vector<BodyPair> pairs;
    for (const auto& [a, b] : numbers) pairs.push_back({a, b});
    return pairs;
}

std::unique_ptr<Answer> run_arrays(const std::shared_ptr<Collider>& collider, nb::handle poses,
                                   nb::handle vertices, nb::handle next_poses, nb::handle next_vertices,
                                   const std::optional<BodyPairNumbers>& body_pairs) {
    auto input = input_of(*collider, {poses, vertices}, {next_poses, next_vertices});
    if (!input) return nullptr;
    if (body_pairs) input->body_pairs = body_pairs_of(*body_pairs);
    return run(collider, *input);
}

/// (body pairs or None, a stream's address or None).
using EnqueueOptions = std::tuple<std::optional<BodyPairNumbers>, std::optional<std::uintptr_t>>;

std::unique_ptr<Queued> enqueue_arrays(const std::shared_ptr<Collider>& collider, nb::handle poses,
                                       nb::handle vertices, nb::handle next_poses, nb::handle next_vertices,
                                       const EnqueueOptions& options) {
    auto input = input_of(*collider, {poses, vertices}, {next_poses, next_vertices});
    if (!input) return nullptr;
    const auto& [body_pairs, stream] = options;
    if (body_pairs) input->body_pairs = body_pairs_of(*body_pairs);
    const nb::gil_scoped_release released;
    auto [frame, number] =
        collider->enqueue(*input, stream ? std::optional(reinterpret_cast<void*>(*stream)) : std::nullopt);
    return std::make_unique<Queued>(collider, std::move(frame), number);
}

/// (numbers of bodies, a row of their poses each or None, {body: vertices} or None).
using ChangeTuple = std::tuple<std::vector<std::uint32_t>, nb::object, nb::object>;

ChangeArguments changes_of(const ChangeTuple& changes) {
    const auto& [posed, poses, vertices] = changes;
    return {posed, poses, vertices};
}

std::unique_ptr<Answer> update(const std::shared_ptr<Collider>& collider, const ChangeTuple& frame,
                               const std::optional<ChangeTuple>& next,
                               const std::optional<BodyPairNumbers>& body_pairs) {
    auto input =
        update_of(*collider, changes_of(frame), next ? std::optional(changes_of(*next)) : std::nullopt);
    if (body_pairs) input.body_pairs = body_pairs_of(*body_pairs);
    return run(collider, input);
}

/// Address of the queue that producers of DLPack arrays get, 0 for the default stream.
std::uintptr_t queue(const Collider& collider) {
    return reinterpret_cast<std::uintptr_t>(collider.devices().front()->queue());
}

void bind_options(nb::module_& module) {
    nb::class_<ColliderOptions>(module, "ColliderOptions",
                                "bodies, deformable, groups: one entry per body of all worlds, of groups the "
                                "bits of its groups and of those it meets. stream: an address.")
        .def(nb::init<std::vector<std::uint32_t>, std::vector<bool>, std::string, std::string, std::string,
                      SettingTexts, std::vector<std::pair<std::uint32_t, std::uint32_t>>,
                      std::vector<std::pair<std::uint32_t, std::uint32_t>>, std::size_t,
                      std::optional<std::uintptr_t>>(),
             nb::arg("bodies"), nb::arg("deformable"), nb::arg("algorithm"), nb::arg("preset"),
             nb::arg("device"), nb::arg("settings"), nb::arg("groups"), nb::arg("never_meet"),
             nb::arg("worlds"), nb::arg("stream").none());
}

/// Calls with the arrays of a frame.
void bind_runs(nb::class_<Collider>& collider) {
    const auto run_device_input = [](const std::shared_ptr<Collider>& self, nb::handle poses,
                                     const nb::list& vertices, nb::handle next_poses,
                                     const std::optional<nb::list>& next_vertices) {
        const nb::object next = next_vertices ? nb::object(*next_vertices) : nb::none();
        return run(self, device_input(*self, {poses, vertices}, {next_poses, next}));
    };
    collider
        .def("run", &run_arrays, nb::arg("poses").none(), nb::arg("vertices").none(),
             nb::arg("next_poses").none(), nb::arg("next_vertices").none(), nb::arg("body_pairs").none(),
             nb::sig(
                 "def run(self, poses: object | None, vertices: object | None, next_poses: object | None, "
                 "next_vertices: object | None, body_pairs: list[tuple[int, int]] | None) -> Answer | None"),
             "Runs a frame. vertices, next_vertices: a list with one array per deformable body, or "
             "{number: array}. Returns None for any other container.")
        .def("enqueue", &enqueue_arrays, nb::arg("poses").none(), nb::arg("vertices").none(),
             nb::arg("next_poses").none(), nb::arg("next_vertices").none(), nb::arg("options"),
             nb::sig("def enqueue(self, poses: object | None, vertices: object | None, next_poses: object | "
                     "None, next_vertices: object | None, options: tuple[list[tuple[int, int]] | None, int | "
                     "None]) -> Queued | None"),
             "As run(), without a wait. options: body pairs, and the address of the stream in whose order it "
             "runs.")
        .def("update", &update, nb::arg("frame"), nb::arg("next").none(), nb::arg("body_pairs").none(),
             "Runs the last frame with changes: numbers of bodies, an array of their poses or None, and "
             "{number: vertices} or None. next: changes from that frame to its successor.")
        .def("run_device_input", run_device_input, nb::arg("poses").none(), nb::arg("vertices"),
             nb::arg("next_poses") = nb::none(), nb::arg("next_vertices") = nb::none(),
             "Runs a frame whose arrays are all in memory of the device; for device host, in host memory. "
             "vertices and next_vertices have one entry per body.")
        .def("tune", &tune, nb::arg("poses").none(), nb::arg("vertices").none(), nb::arg("seconds"),
             nb::arg("next_poses").none(), nb::arg("next_vertices").none(),
             nb::sig("def tune(self, poses: object | None, vertices: object | None, seconds: float, "
                     "next_poses: object | None, next_vertices: object | None) -> list | None"));
}

} // namespace

void bind_collider(nb::module_& module) {
    module.def("algorithms", &algorithm_names, "Names of the algorithms that Collider accepts besides auto.");
    bind_options(module);
    const auto released = nb::call_guard<nb::gil_scoped_release>();
    nb::class_<Collider> collider(module, "Collider",
                                  "Implementation of tandem.Collider, which checks its input.");
    bind_runs(collider);
    collider.def(nb::new_(&make), nb::arg("meshes"), nb::arg("options"), nb::arg("owner").none())
        .def("reset", &Collider::reset, released)
        .def_prop_ro("algorithm", &Collider::algorithm, released)
        .def_prop_ro("settings", &Collider::setting_texts, released)
        .def_prop_ro("devices", &device_names)
        .def_prop_ro("queue", &queue)
        .def_prop_ro("nothing_meets", &Collider::nothing_meets,
                     "Why nothing can meet in any frame, or an empty text.")
        .def_prop_ro(
            "addresses", &Collider::addresses, released,
            "Addresses from which kernels read the last frame that was in memory of the device: poses "
            "(0 for none), then vertices of each deformable body. Those of its successor follow.");
}

} // namespace tandem::python
