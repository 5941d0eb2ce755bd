// SPDX-License-Identifier: MIT
#include "python/core/collider.h"

#include "algorithms/bodies/range.h"
#include "backends/cuda/cuda_device.h"
#include "base/error.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <fmt/format.h>

namespace tandem::python {

namespace {

constexpr double seconds_of_choosing = 2; ///< in the first frame, where tune was not called

/// Rigid bodies have the identity as their pose, deformable bodies the vertices of their mesh.
Frame rest_frame(const Scene& scene) {
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
        const auto [groups, meets] = options.groups[body];
        scene.bodies.push_back({.mesh = mesh,
                                .fixed = false,
                                .deformable = options.deformable[body],
                                .groups = groups,
                                .meets = meets});
    }
    for (const auto& [a, b] : options.never_meet)
        scene.never_meet.push_back({std::min(a, b), std::max(a, b)});
    std::ranges::sort(scene.never_meet);
    return scene;
}

/// Candidates of algorithm auto, by the rules of `tandem run`.
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
            fmt::format("stream: device {} is not a CUDA device; streams need one, such as cuda:0", device));
    return number;
}

} // namespace

Collider::Collider(std::vector<Mesh> meshes, const ColliderOptions& options) : algorithm_(options.algorithm) {
    if (algorithm_ != automatic)
        tandem::algorithm(algorithm_); // reports an unknown name before devices are opened
    open_devices(options);
    scene_ = scene_of(std::move(meshes), options);
    scene_.frame = [this](std::size_t) { return rest_frame(scene_); };
    frame_ = rest_frame(scene_);
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
        throw InputError("device=all names several devices; give one, or several that share the work as D+E");
    devices_ = std::move(groups.front());
}

/// Also checks the meshes; frames are checked without them.
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

template<class AnyFrame>
std::pair<FrameResult, double> Collider::run_frame(const AnyFrame& frame) {
    if (!session_) choose_for(frame, seconds_of_choosing);
    const auto begin = std::chrono::steady_clock::now();
    auto result = session_->run(frame);
    return {std::move(result),
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
}

std::pair<FrameResult, double> Collider::run(const Input& input) {
    const std::lock_guard lock(mutex_);
    return input.on_device ? run_frame(device_frame(input)) : run_frame(host_frame(input));
}

template<class AnyFrame>
std::vector<Trial> Collider::choose_for(const AnyFrame& frame, double seconds) {
    auto chosen = choose(
        candidates_, scene_, [&](Session& session) { return session.run(frame); }, seconds);
    session_ = std::move(chosen.session);
    algorithm_ = chosen.algorithm->name();
    return std::move(chosen.trials);
}

std::vector<Trial> Collider::tune(const Input& input, double seconds) {
    const std::lock_guard lock(mutex_);
    if (candidates_.empty())
        throw InputError(
            fmt::format("tune: algorithm {} was named; make the collider with algorithm=auto", algorithm_));
    return input.on_device ? choose_for(device_frame(input), seconds)
                           : choose_for(host_frame(input), seconds);
}

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

/// The copy counts coordinates that are out of range. Only then the library's slower check runs, which throws
/// the error message.
const Frame& Collider::host_frame(const Input& input) {
    out_of_range_ = 0;
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
    if (out_of_range_ > 0) check_range(scene_, frame_, precision_);
    return frame_;
}

const DeviceFrame& Collider::device_frame(const Input& input) {
    if (!device_input_) device_input_ = std::make_unique<DeviceInput>(*devices_.front(), scene_);
    return device_input_->frame(input.poses, input.vertices);
}

void Collider::set_poses(const GivenRows& poses) {
    if (poses.rows != bodies())
        throw InputError(
            fmt::format("poses: {} rows for {} bodies; give each body its row", poses.rows, bodies()));
    for (std::size_t body = 0; body < bodies(); ++body) {
        if (scene_.bodies[body].deformable) {
            frame_.poses[body] = {};
            continue;
        }
        frame_.poses[body] = pose_of_row(static_cast<const double*>(poses.data) + 7 * body, body);
        for (const double x : frame_.poses[body].translation) out_of_range_ += !(std::abs(x) <= limit_);
    }
}

void Collider::set_vertices(std::size_t body, const GivenRows& vertices) {
    const auto count = scene_.meshes[scene_.bodies[body].mesh].vertices.size();
    if (vertices.rows != count)
        throw InputError(fmt::format("vertices: {} rows for body {}, whose mesh has {} vertices",
                                     vertices.rows, body, count));
    auto& points = frame_.deformed[body];
    points.resize(count);
    static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
    const auto* const from = static_cast<const double*>(vertices.data);
    auto* const to = reinterpret_cast<double*>(points.data());
    std::size_t out_of_range = 0; // a local variable, so that the loop is vectorised
    for (std::size_t i = 0; i < 3 * count; ++i) {
        out_of_range += !(std::abs(from[i]) <= limit_);
        to[i] = from[i];
    }
    out_of_range_ += out_of_range;
}

} // namespace tandem::python
