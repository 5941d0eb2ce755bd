// SPDX-License-Identifier: MIT
// Makes sessions from resolved settings, and chooses the data path.
#include "algorithms/bodies/check_input.h"
#include "algorithms/bodies/cost.h"
#include "algorithms/bodies/frame_on_device.h"
#include "algorithms/bodies/origin.h"
#include "algorithms/bodies/shift.h"
#include "algorithms/pipeline/pipeline.h"
#include "algorithms/published/published_session.h"
#include "algorithms/distributed/local_scene.h"
#include "algorithms/distributed/rank_session.h"
#include "algorithms/pipeline/resident_session.h"
#include "algorithms/distributed/split_session.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem {

namespace {

/// "host + opencl:0"
std::string names_of(std::span<Device* const> devices) {
    std::vector<std::string> names;
    for (const auto* device : devices) names.push_back(device->info().id);
    return fmt::format("{}", fmt::join(names, " + "));
}

/// Throws InputError unless there are devices, each named once.
void check_devices(const Traversal& traversal, std::span<Device* const> devices) {
    if (devices.empty()) throw InputError(fmt::format("{} needs a device to run on", traversal.name()));
    for (std::size_t i = 0; i < devices.size(); ++i) {
        if (devices[i] == nullptr)
            throw InputError(fmt::format("devices: number {} is a null pointer; open a device first", i));
        if (std::ranges::count(devices.first(i), devices[i]) != 0)
            throw InputError(
                fmt::format("devices: {} is named twice; name each device once", devices[i]->info().id));
    }
}

/// Throws InputError if several devices cannot split a frame with these settings.
void check_split(const Traversal& traversal, std::span<Device* const> devices, const Settings& settings) {
    if (devices.size() < 2) return;
    if (walks_part(settings))
        throw InputError(
            fmt::format("settings first_body_pair and most_body_pairs are for one device, and {} "
                        "were named; name one, or leave them out",
                        names_of(devices)));
    if (is_published(settings))
        throw InputError(
            fmt::format("{} with residency=published cannot split a frame between {}: the paper's data path "
                        "has one device; name one device, or leave residency and preset out",
                        traversal.name(), names_of(devices)));
}

} // namespace

void Session::set_threads() const {
    static_assert(parameters::threads.most == most_threads);
    const auto threads = static_cast<std::uint32_t>(settings()[parameters::threads]);
    for (auto* device : devices()) device->set_threads(threads);
}

void Session::check_pairs(std::optional<std::span<const BodyPair>> body_pairs, bool checked) const {
    if (!body_pairs) return;
    const bool has_self = settings()[parameters::self] != SelfPairs::off;
    if (checked && has_self) return;
    for (const auto& pair : *body_pairs) {
        if (!checked && (pair.a > pair.b || pair.b >= scene_->bodies.size()))
            throw InputError(fmt::format("run() got the body pair {}, {}; give a <= b below {}", pair.a,
                                         pair.b, scene_->bodies.size()));
        if (!has_self && pair.a == pair.b)
            throw InputError(fmt::format("run() got a pair of body {} with itself; set self=on or "
                                         "self=deformable",
                                         pair.a));
    }
}

void Session::check_motion(bool has_next) const {
    const bool needs_next = settings()[parameters::motion] == Motion::linear;
    if (needs_next && !has_next)
        throw InputError("setting motion=linear needs the frame's successor; call run({frame, next})");
    if (!needs_next && has_next)
        throw InputError("run() got a frame's successor; set motion=linear, or call run(frame)");
}

void Session::check_frames(const FrameInput& input) const {
    const auto geometry = geometry_of(settings());
    if (input.next != nullptr) check_successor(input.frame, *input.next);
    check_frame(*scene_, input.frame, geometry, owned());
    if (input.next != nullptr) of_successor([&] { check_frame(*scene_, *input.next, geometry, owned()); });
}

void Session::begin_at(const Scene& scene, std::shared_ptr<const Scene> centred) {
    scene_ = &scene;
    deformable_ = deformable_bodies(scene);
    centred_ = std::move(centred);
    const auto setting = geometry_of(settings()).origin;
    first_frame_places_ = setting == Origin::automatic && !scene.frame;
    is_placed_ = !first_frame_places_;
    origin_ = origin_of(scene, setting);
}

void Session::place(const Frame& frame) {
    if (is_placed_) return;
    const auto origin = middle_of(*scene_, frame);
    if (origin == origin_) return;
    origin_ = origin;
    do_move_origin();
}

template<class Work>
auto Session::with_host_input(const FrameInput& input, const Work& work) {
    place(input.frame);
    const bool at_origin = origin_ == Eigen::Vector3d::Zero() && !centred_;
    const bool skips_more = input.next != nullptr && input.frame.skipped != input.next->skipped;
    if (at_origin && !skips_more) return work(input);
    auto frame = at_origin ? input.frame : as_on_devices(input.frame);
    if (input.next == nullptr) return work(frame);
    if (skips_more) frame.skipped = skipped_in_either(input.frame.skipped, input.next->skipped);
    if (at_origin) return work({frame, input.next});
    const auto next = as_on_devices(*input.next);
    return work({frame, &next});
}

Frame Session::as_on_devices(const Frame& frame) const {
    auto counted = counted_from(origin_, frame);
    return centred_ ? shifted(*centred_, std::move(counted)) : counted;
}

template<class Work>
auto Session::with_device_input(const DeviceFrameInput& input, const Work& work) {
    check_fits(*scene_, deformable_, input.frame);
    if (!is_placed_ && devices().size() == 1) // several devices refuse the frame
        place(downloaded(*devices().front(), *scene_, input.frame));
    if (input.next != nullptr) check_fits(*scene_, deformable_, *input.next);
    if (input.next == nullptr || input.frame.skipped == input.next->skipped) return work(input);
    auto frame = input.frame;
    frame.skipped = skipped_in_either(input.frame.skipped, input.next->skipped);
    return work({frame, input.next});
}

void Session::check_call(const FrameView& view, std::optional<std::span<const BodyPair>> body_pairs) const {
    check_motion(view.has_next());
    if (view.on_host() && !view.is_checked()) check_frames(*view.on_host());
    check_pairs(body_pairs, view.is_checked());
    set_threads();
}

FrameResult Session::run_among(const FrameView& view, std::optional<std::span<const BodyPair>> body_pairs) {
    check_call(view, body_pairs);
    return finished(view.on_host() ? with_host_input(
                        *view.on_host(), [&](const FrameInput& input) { return do_run(input, body_pairs); })
                                   : with_device_input(*view.on_device(), [&](const DeviceFrameInput& input) {
                                         return do_run_device_input(input, body_pairs);
                                     }));
}

QueuedFrame Session::enqueue_among(const FrameView& view,
                                   std::optional<std::span<const BodyPair>> body_pairs) {
    check_call(view, body_pairs);
    const bool is_captured = devices().size() == 1 && devices().front()->is_captured();
    if (is_captured && (view.on_host() || body_pairs))
        throw InputError(
            "enqueue() in a capture got a frame or body pairs in the host's memory, which the graph "
            "would not read again; give a DeviceFrame alone");
    if (is_captured && !is_placed_) refuse_capture();
    auto frame =
        view.on_host() ? with_host_input(
            *view.on_host(), [&](const FrameInput& input) { return do_enqueue(&input, nullptr, body_pairs); })
                       : with_device_input(*view.on_device(), [&](const DeviceFrameInput& input) {
                             return do_enqueue(nullptr, &input, body_pairs);
                         });
    std::copy_n(origin_.data(), 3, frame.origin.begin());
    is_placed_ = true;
    return frame;
}

/// A session inside this one has subtracted an origin of its own, if any.
FrameResult Session::finished(FrameResult result) {
    for (auto* device : devices()) device->check_guards();
    for (std::size_t axis = 0; axis < 3; ++axis)
        result.origin[axis] += origin_[static_cast<Eigen::Index>(axis)];
    result.has_points = settings()[parameters::output] != Output::wrenches;
    is_placed_ = true;
    if (centred_)
        for (auto& part : result.parts) part = owning_part(std::move(part), centred_);
    return result;
}

FrameResult Session::do_run_device_input(const DeviceFrameInput&, std::optional<std::span<const BodyPair>>) {
    const auto* const why = devices().size() > 1
                                ? "several devices share a frame, which the host partitions; name one device"
                                : "residency=published converts every frame on the host; leave it out";
    throw InputError(fmt::format("{}: {}, or give the frame in the host's memory", names_of(devices()), why));
}

void Traversal::do_fit(Settings&, const DeviceInfo&, const Scene*) const {}

std::vector<KernelCost> Traversal::do_costs(const Scene&, const Settings&) const { return {}; }

void Session::refuse_capture() {
    throw InputError(
        "enqueue() in a capture has memory to allocate and kernels to compile; enqueue a frame before "
        "the capture, and again after a run() that has grown buffers");
}

QueuedFrame Session::do_enqueue(const FrameInput*, const DeviceFrameInput*,
                                std::optional<std::span<const BodyPair>>) {
    const auto* const why = devices().size() > 1 ? "several devices share a frame, which the host collects"
                                                 : "residency=published waits in every frame";
    throw InputError(fmt::format("{}: {}; call run() instead of enqueue()", names_of(devices()), why));
}

std::optional<FrameResult> Session::do_collect() {
    throw InputError("collect() needs a frame; call enqueue() first");
}

std::vector<KernelCost> Traversal::costs(const Scene& scene, const Settings& settings) const {
    const SceneFacts facts(scene, settings);
    auto all = do_costs(scene, settings);
    for (const auto& common : {body_costs(facts), broad_costs(facts), contact_costs(facts),
                               answer_costs(facts), published_costs(facts)})
        all.insert(all.end(), common.begin(), common.end());
    return all;
}

AlgorithmStages Traversal::build(const BuildContext& context) const { return do_build(context); }

SettingTexts with_rule_of_output(SettingTexts given) {
    const auto output = given.find("output");
    if (output == given.end()) return given;
    if (output->second == "distances") given.try_emplace("contact_rule", "distance");
    if (output->second == "wrenches") given.try_emplace("contact_rule", "pressure");
    return given;
}

SettingTexts with_reliable_contacts(SettingTexts given) {
    given = with_rule_of_output(std::move(given));
    given.try_emplace("contact_rule", "sat");
    given.try_emplace("decision", "usual");
    return given;
}

Settings Traversal::settings(const SettingTexts& given, std::string_view preset) const {
    const auto& chosen = preset.empty() ? presets().front() : tandem::preset(*this, preset);
    return resolve(parameters(), chosen.values,
                   chosen.reproduces ? with_rule_of_output(given) : with_reliable_contacts(given), name());
}

void Traversal::check(std::span<Device* const> devices, const Settings& settings) const {
    for (const auto* device : devices) fitted(settings, device->info());
    check_split(*this, devices, settings);
}

std::unique_ptr<Session> Traversal::prepare(std::span<Device* const> devices, const Scene& scene,
                                            const Settings& settings) const {
    check_devices(*this, devices);
    if (scene.bodies.empty()) throw InputError(fmt::format("scene {} has no bodies", scene.name));
    check_scene(scene, geometry_of(settings));
    check_split(*this, devices, settings);
    std::vector<Settings> fitting;
    for (const auto* device : devices) fitting.push_back(fitted(settings, device->info(), &scene));
    auto& device = *devices.front();
    const auto origin = geometry_of(settings).origin;
    const auto moved = centred(scene, origin);
    const auto& on_devices = moved ? *moved : scene;
    std::unique_ptr<Session> session;
    compile_together(devices, [&] {
        session = devices.size() > 1 ? split_session(*this, devices, on_devices, fitting)
                  : is_published(settings)
                      ? published_session(*this, device, on_devices, fitting.front())
                      : std::make_unique<ResidentSession>(*this, device, on_devices, fitting.front());
    });
    session->begin_at(scene, moved);
    return session;
}

std::unique_ptr<Session> Traversal::prepare(Device& device, const Scene& scene, const Settings& settings,
                                            Ranks& ranks) const {
    if (scene.bodies.empty()) throw InputError(fmt::format("scene {} has no bodies", scene.name));
    check_scene(scene, geometry_of(settings));
    if (is_published(settings))
        throw InputError(
            fmt::format("{} with residency=published cannot share a frame between ranks: the paper's "
                        "data path has one device; leave residency and preset out",
                        name()));
    if (settings[tandem::parameters::broad] != Broad::device)
        throw InputError(
            fmt::format("setting broad={} does not go with ranks of a job, none of which has all "
                        "bodies; choose broad=device",
                        settings.text("broad")));
    if (!scene.frame)
        throw InputError("ranks of a job divide the bodies of frame 0, and Scene::frame is not set; set it");
    const auto moved = centred(scene, geometry_of(settings).origin);
    std::unique_ptr<Session> session = std::make_unique<RankSession>(
        *this, device, moved ? *moved : scene, fitted(settings, device.info(), &scene), ranks);
    session->begin_at(scene, moved);
    return session;
}

} // namespace tandem
