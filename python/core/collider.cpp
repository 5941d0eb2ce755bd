// SPDX-License-Identifier: MIT
#include "python/core/collider.h"

#include "algorithms/bodies/nothing_meets.h"
#include "algorithms/bodies/range.h"
#include "algorithms/parameters/table.h"
#include "backends/cuda/cuda_device.h"
#include "base/error.h"
#include "harness/choosing/race.h"
#include "base/statistics.h"
#include "python/core/device_world.h"
#include "python/core/signals.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <fmt/format.h>

namespace tandem::python {

namespace {

constexpr double seconds_of_choosing = 2; ///< in the first frame, where tune was not called

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
    if (options.worlds > 1)
        scene.world_size = static_cast<std::uint32_t>(scene.bodies.size() / options.worlds);
    return scene;
}

/// Whether a preset of that name reproduces a program of others, which has its own contacts.
bool reproduces(const std::string& name) {
    return std::ranges::any_of(algorithms(), [&](const Traversal* traversal) {
        return std::ranges::any_of(traversal->presets(), [&](const Preset& preset) {
            return preset.name == name && preset.reproduces;
        });
    });
}

/// Candidates of algorithm auto, by the rules of `tandem run` but for the default contacts.
std::vector<Cell> candidates_of(const ColliderOptions& options, const DeviceGroup& devices) {
    Request request{
        .algorithms = {std::string(automatic)}, .presets = {}, .devices = {}, .sets = {}, .may_choose = true};
    if (!options.preset.empty()) request.presets = {options.preset};
    const auto settings =
        reproduces(options.preset) ? options.settings : with_reliable_contacts(options.settings);
    for (const auto& [name, value] : settings) request.sets.emplace_back(name, std::vector{value});
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

using BodyPairs = std::optional<std::span<const BodyPair>>;

/// HostInput has checked frames of the host; the device checks those in its memory.
FrameResult run_among(Session& session, const FrameView& frames, const BodyPairs& pairs) {
    return pairs ? session.run(frames.checked(), *pairs) : session.run(frames.checked());
}

} // namespace

Collider::Collider(std::vector<Mesh> meshes, const ColliderOptions& options) : algorithm_(options.algorithm) {
    if (algorithm_ != automatic)
        tandem::algorithm(algorithm_); // reports an unknown name before devices are opened
    open_devices(options);
    scene_ = scene_of(std::move(meshes), options);
    prepare(options);
}

/// A fork leaves nothing of the devices' runtimes that could free their memory, and a call would hang.
Collider::~Collider() {
    if (!is_lost()) return;
    static_cast<void>(session_.release());
    static_cast<void>(new auto(std::move(device_input_)));
    static_cast<void>(new auto(std::move(backends_)));
}

std::unique_lock<std::recursive_mutex> Collider::lock() {
    if (has_runtime(devices_)) check_process(name_of(devices_));
    std::unique_lock own(mutex_);
    if (runs_)
        throw InputError("the collider is in a run that this signal interrupts; use it and its answers after "
                         "the run");
    return own;
}

/// The thread that has the lock may be waiting for the interpreter's.
std::unique_lock<std::recursive_mutex> Collider::lock_at_end() {
    std::unique_lock own(mutex_, std::try_to_lock);
    if (own) return own;
    const nanobind::gil_scoped_release released;
    own.lock();
    return own;
}

template<class Work>
auto Collider::with_signals(const Work& work) {
    struct Running {
        bool& runs;
        explicit Running(bool& flag) : runs(flag) { runs = true; }
        ~Running() { runs = false; }
    };
    const Running running(runs_);
    return Signals(devices_).within(work);
}

void Collider::open_devices(const ColliderOptions& options) {
    if (options.device != "host") {
        check_process(options.device);
        note_runtime();
    }
    if (options.stream) {
        BackendReport cuda{.name = "cuda", .devices = {}, .reason = {}, .drivers = {}};
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
        settings = traversal->settings(options.settings, options.preset);
    }
    geometry_ = geometry_of(settings);
    motion_ = settings[parameters::motion];
    nothing_meets_ = why_nothing_meets(scene_, settings[parameters::self]);
    host_input_.emplace(scene_, geometry_);
    check_range(scene_, rest_frame(scene_), geometry_);
    if (traversal == nullptr) return;
    session_ = traversal->prepare(devices_, scene_, settings);
}

template<class Frames>
FrameResult Collider::run_frame(Session& session, const Frames& frames,
                                const std::optional<std::vector<BodyPair>>& given) {
    ++frames_;
    return run_among(session, frames, given ? BodyPairs(*given) : std::nullopt);
}

template<class Frames>
CollideRun Collider::run_frames(const Frames& frames,
                                const std::optional<std::vector<BodyPair>>& body_pairs) {
    if (!session_) choose_for(frames, seconds_of_choosing);
    const auto begin = std::chrono::steady_clock::now();
    auto result = run_frame(*session_, frames, body_pairs);
    return {std::move(result),
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
            {},
            frames_};
}

oracle::World Collider::world_of(std::uint64_t number, const char* asks) const {
    const auto* const bodies = session_->bodies();
    if (number != frames_ || bodies == nullptr)
        throw InputError(
            fmt::format("{0} needs the frame, which was in memory of the device and is overwritten "
                        "by a later run; call {0} before the next run, or give arrays in host memory",
                        asks));
    return world_on_device(*bodies);
}

CollideRun Collider::run(const Input& input) {
    const auto own = lock();
    check(input);
    return with_signals([&] {
        if (input.on_device) return run_frames(device_frames(input), input.body_pairs);
        auto run = run_frames(host_frames(input), input.body_pairs);
        run.frame = host_input_->last();
        return run;
    });
}

std::pair<QueuedFrame, std::uint64_t> Collider::enqueue(const Input& input, std::optional<void*> stream) {
    const auto own = lock();
    check(input);
    auto& device = *devices_.front();
    return with_signals([&] {
        if (stream) device.follow(*stream);
        const auto enqueued = [&](const auto& frames) {
            if (!session_) choose_for(frames, seconds_of_choosing);
            last_queued_ = ++frames_;
            const auto view = FrameView(frames).checked();
            return input.body_pairs ? session_->enqueue(view, *input.body_pairs) : session_->enqueue(view);
        };
        auto frame = input.on_device ? enqueued(device_frames(input)) : enqueued(host_frames(input));
        const auto caller = stream || !input.on_device ? stream : device_input_->followed();
        if (!caller && device.is_captured())
            throw InputError("enqueue() in a capture does not know the stream of its arrays; give stream=");
        if (caller) device.precede(*caller);
        return std::pair(std::move(frame), frames_);
    });
}

void Collider::check_queued(std::uint64_t number) const {
    if (number != last_queued_)
        throw InputError(
            "the answer of collect() is in memory that a later enqueue() has overwritten; read each "
            "answer before the next frame, or call run()");
}

std::optional<CollideRun> Collider::collect(std::uint64_t number) {
    const auto own = lock();
    check_queued(number);
    return with_signals([&]() -> std::optional<CollideRun> {
        auto result = session_->collect();
        if (!result) return std::nullopt;
        return CollideRun{*std::move(result), 0, {}, number};
    });
}

/// Keeps a session of the fastest candidate. Returns all timed ones, the fastest first. Throws InputError
/// with the first error when all fail.
template<class Frames>
std::vector<Trial> Collider::choose_for(const Frames& frames, double seconds) {
    std::vector<std::unique_ptr<Session>> sessions(candidates_.size());
    const auto prepare = [&](std::size_t i) {
        if (!sessions[i])
            sessions[i] = candidates_[i].algorithm->prepare(devices_, scene_, candidates_[i].settings);
    };
    const auto replay = [&](std::size_t i) -> Replayed {
        const auto begin = std::chrono::steady_clock::now();
        const auto result = run_frame(*sessions[i], frames, std::nullopt);
        const std::chrono::nanoseconds time = std::chrono::steady_clock::now() - begin;
        return {time.count(), result.count, result.contacts};
    };
    Race race(candidates_,
              {.prepare = prepare, .replay = replay, .free = [&](std::size_t i) { sessions[i].reset(); }});
    const auto ranking = race.run(seconds);
    if (ranking.empty()) throw InputError(race.failure(0));
    const auto best = ranking.front();
    prepare(best);
    session_ = std::move(sessions[best]);
    algorithm_ = candidates_[best].algorithm->name();
    std::vector<Trial> trials;
    for (const auto i : ranking)
        trials.push_back({std::string(candidates_[i].algorithm->name()), changes(candidates_[i]),
                          1e-9 * median(race.times(i))});
    return trials;
}

std::vector<Trial> Collider::tune(const Input& input, double seconds) {
    const auto own = lock();
    if (candidates_.empty())
        throw InputError(
            fmt::format("tune: algorithm {} was named; make the collider with algorithm=auto", algorithm_));
    check(input);
    return with_signals([&] {
        return input.on_device ? choose_for(device_frames(input), seconds)
                               : choose_for(host_frames(input), seconds);
    });
}

void Collider::reset() {
    const auto own = lock();
    if (session_) session_->reset();
}

std::string Collider::algorithm() {
    const std::lock_guard own(mutex_);
    return algorithm_;
}

SettingTexts Collider::setting_texts() {
    const std::lock_guard own(mutex_);
    return session_ ? session_->settings().texts() : SettingTexts{};
}

std::vector<std::uintptr_t> Collider::addresses() {
    const std::lock_guard own(mutex_);
    return device_input_ ? device_input_->addresses() : std::vector<std::uintptr_t>{};
}

void Collider::check(const Input& input) const {
    if (motion_ == Motion::linear && !input.next)
        throw InputError("setting motion=linear needs the frame's successor; give next_poses or "
                         "next_vertices");
    if (motion_ == Motion::none && input.next)
        throw InputError("next_poses and next_vertices are for setting motion=linear; make the collider with "
                         "motion=linear, or leave them out");
    check_rows(scene_, input);
    if (input.updates) check_update(input);
}

void Collider::check_update(const Input& input) const {
    if (input.on_device)
        throw InputError("update() takes arrays in host memory; write the changes into the arrays on the "
                         "device, and give those to run()");
    if (is_last_on_device_)
        throw InputError("update() changes frames in host memory, and arrays of the last run were on the "
                         "device; write the changes there, and give the arrays to run()");
    if (!host_input_->last())
        throw InputError("update() has no frame to change; give run() the first frame, of all bodies");
}

FrameInput Collider::host_frames(const Input& input) {
    const auto last = host_input_->last();
    const auto& frame = host_input_->frame(input.frame, input.updates ? last.get() : nullptr);
    is_last_on_device_ = false;
    if (!input.next) return frame;
    if (!next_host_input_) next_host_input_.emplace(scene_, geometry_);
    return {frame, of_successor([&] {
                return &next_host_input_->frame(*input.next, input.updates ? &frame : nullptr);
            })};
}

DeviceFrameInput Collider::device_frames(const Input& input) {
    is_last_on_device_ = true;
    if (!device_input_) device_input_.emplace(*devices_.front(), scene_);
    return device_input_->frames(input);
}

} // namespace tandem::python
