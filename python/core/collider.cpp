// SPDX-License-Identifier: MIT
#include "python/core/collider.h"

#include "algorithms/bodies/range.h"
#include "backends/cuda/cuda_device.h"
#include "python/core/answer.h"
#include "python/core/plain_input.h"
#include "scenes/error.h"

#include <algorithm>
#include <charconv>
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

constexpr double seconds_of_choosing = 2; ///< by a first frame that nothing was tuned to

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

/// What algorithm auto may become, by the program's own rules.
std::vector<Cell> candidates_of(const ColliderOptions& options, const DeviceGroup& devices) {
    Request request{
        .algorithms = {std::string(automatic)}, .presets = {}, .devices = {}, .sets = {}, .may_choose = true};
    if (!options.preset.empty()) request.presets = {options.preset};
    for (const auto& [name, value] : options.settings) request.sets.emplace_back(name, std::vector{value});
    return std::move(plan(request, {&devices, 1}).front().candidates);
}

/// The number of a device "cuda:N".
std::size_t cuda_number(const std::string& device) {
    constexpr std::string_view cuda = "cuda:";
    std::size_t number = 0;
    const auto* const end = device.data() + device.size();
    if (!device.starts_with(cuda) || std::from_chars(device.data() + cuda.size(), end, number).ptr != end)
        throw InputError(
            fmt::format("stream: device {} is not one of CUDA's, which streams belong to; name one as "
                        "cuda:0",
                        device));
    return number;
}

} // namespace

Collider::Collider(std::vector<Mesh> meshes, const ColliderOptions& options) : algorithm_(options.algorithm) {
    if (algorithm_ != automatic) tandem::algorithm(algorithm_); // the first word that may be wrong
    open_devices(options);
    scene_ = scene_of(std::move(meshes), options);
    scene_.frame = [this](std::size_t) { return rest(scene_); };
    frame_ = rest(scene_);
    prepare(options);
}

void Collider::open_devices(const ColliderOptions& options) {
    if (options.stream) {
        BackendReport cuda{.name = "cuda", .devices = {}, .reason = {}};
        cuda.devices.push_back(
            cuda::on_stream(cuda_number(options.device), reinterpret_cast<void*>(*options.stream)));
        devices_ = {cuda.devices.front().get()};
        backends_.push_back(std::move(cuda));
        return;
    }
    const std::vector<std::string> names{options.device};
    backends_ = open_backends(names, {});
    auto groups = choose_devices(backends_, names);
    if (groups.size() != 1)
        throw InputError("device=all names several; give one, or several that share the work as D+E");
    devices_ = std::move(groups.front());
}

/// Meshes are looked at once, here.
void Collider::prepare(const ColliderOptions& options) {
    Settings settings;
    const Traversal* traversal = nullptr;
    if (algorithm_ == automatic) {
        candidates_ = candidates_of(options, devices_);
        settings = candidates_.front().settings;
    } else {
        traversal = &tandem::algorithm(algorithm_);
        const auto& chosen =
            options.preset.empty() ? traversal->presets().front() : preset(*traversal, options.preset);
        settings = resolve(traversal->parameters(), chosen.values, options.settings, traversal->name());
    }
    precision_ = geometry_of(settings).precision;
    limit_ = largest_coordinate(precision_);
    check_range(scene_, frame_, precision_);
    if (traversal != nullptr) session_ = traversal->prepare(devices_, scene_, settings);
}

template<class Input>
std::pair<FrameResult, double> Collider::run_frame(const Input& input) {
    const std::lock_guard lock(mutex_);
    const auto& frame = frame_of(input);
    if (!session_) choose_for(frame, seconds_of_choosing);
    const auto begin = std::chrono::steady_clock::now();
    auto result = session_->run(frame);
    return {std::move(result),
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
}

std::pair<FrameResult, double> Collider::run(const HostInput& input) { return run_frame(input); }
std::pair<FrameResult, double> Collider::run(const MixedInput& input) { return run_frame(input); }

template<class AnyFrame>
std::vector<Trial> Collider::choose_for(const AnyFrame& frame, double seconds) {
    auto chosen = choose(
        candidates_, scene_, [&](Session& session) { return session.run(frame); }, seconds);
    session_ = std::move(chosen.session);
    algorithm_ = chosen.algorithm->name();
    return std::move(chosen.trials);
}

template<class Input>
std::vector<Trial> Collider::tune_to(const Input& input, double seconds) {
    const std::lock_guard lock(mutex_);
    if (candidates_.empty())
        throw InputError(
            fmt::format("tune: algorithm {} was named; make the collider with algorithm=auto", algorithm_));
    return choose_for(frame_of(input), seconds);
}

std::vector<Trial> Collider::tune(const HostInput& input, double seconds) { return tune_to(input, seconds); }
std::vector<Trial> Collider::tune(const MixedInput& input, double seconds) { return tune_to(input, seconds); }

void Collider::reset() {
    const std::lock_guard lock(mutex_);
    if (session_) session_->reset();
}

std::string Collider::algorithm() {
    const std::lock_guard lock(mutex_);
    return algorithm_;
}

SettingTexts Collider::setting_texts() {
    const std::lock_guard lock(mutex_);
    return session_ ? session_->settings().texts() : SettingTexts{};
}

std::vector<std::uintptr_t> Collider::addresses() {
    const std::lock_guard lock(mutex_);
    return device_input_ ? device_input_->addresses() : std::vector<std::uintptr_t>{};
}

/// What is out of range is counted on the way, not looked for; the library's own check, which looks at meshes
/// as well, has the sentence.
const Frame& Collider::frame_of(const HostInput& input) {
    beyond_ = 0;
    if (input.poses)
        set_poses(*input.poses);
    else
        std::ranges::fill(frame_.poses, Pose{});
    for (std::size_t body = 0; body < bodies(); ++body) {
        if (!scene_.bodies[body].deformable) continue;
        if (body < input.vertices.size() && input.vertices[body])
            set_vertices(body, *input.vertices[body]);
        else
            frame_.deformed[body] = scene_.meshes[scene_.bodies[body].mesh].vertices;
    }
    if (beyond_ > 0) check_range(scene_, frame_, precision_);
    return frame_;
}

const DeviceFrame& Collider::frame_of(const MixedInput& input) {
    if (!device_input_) device_input_ = std::make_unique<DeviceInput>(*devices_.front(), scene_);
    return device_input_->frame(input.poses, input.vertices);
}

void Collider::set_poses(HostRows poses) {
    if (poses.rows != bodies())
        throw InputError(
            fmt::format("poses: {} rows for {} bodies; give each body its row", poses.rows, bodies()));
    for (std::size_t body = 0; body < bodies(); ++body) {
        if (scene_.bodies[body].deformable) {
            frame_.poses[body] = {};
            continue;
        }
        frame_.poses[body] = pose_of_row(poses.data + 7 * body, body);
        for (const double x : frame_.poses[body].translation) beyond_ += !(std::abs(x) <= limit_);
    }
}

void Collider::set_vertices(std::size_t body, HostRows vertices) {
    const auto count = scene_.meshes[scene_.bodies[body].mesh].vertices.size();
    if (vertices.rows != count)
        throw InputError(fmt::format("vertices: {} rows for body {}, whose mesh has {} vertices",
                                     vertices.rows, body, count));
    auto& points = frame_.deformed[body];
    points.resize(count);
    static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
    const auto* const from = vertices.data;
    auto* const to = reinterpret_cast<double*>(points.data());
    std::size_t beyond = 0; // a local: the loop is vector code
    for (std::size_t i = 0; i < 3 * count; ++i) {
        beyond += !(std::abs(from[i]) <= limit_);
        to[i] = from[i];
    }
    beyond_ += beyond;
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
                               std::string device, SettingTexts settings,
                               std::optional<std::uintptr_t> stream, nb::object owner) {
    const nb::gil_scoped_release released;
    std::vector<Mesh> copies;
    for (const auto* mesh : meshes) copies.push_back(*mesh);
    auto collider = std::make_shared<Collider>(
        std::move(copies), ColliderOptions{std::move(bodies), std::move(deformable), std::move(algorithm),
                                           std::move(preset), std::move(device), std::move(settings), stream});
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
