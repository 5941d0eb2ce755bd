// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"
#include "algorithms/answer/queued_frame.h"
#include "algorithms/bodies/body_pair.h"
#include "algorithms/bodies/frame_input.h"
#include "algorithms/kernels/counter.h"
#include "algorithms/parameters/parameter.h"
#include "backends/device.h"
#include "scenes/scene.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace tandem {

class Bodies;           // bodies/bodies.h
class Ranks;            // backends/ranks.h
struct BuildContext;    // bodies/build_context.h
struct KernelCost;      // bodies/cost.h
struct AlgorithmStages; // pipeline/stages.h

/// A scene prepared on its devices for one algorithm and one set of settings: uploaded and compiled. All work
/// in run() is measured, and no work before it. Every function may throw DeviceError; the session remains
/// usable after an error.
class Session {
public:
    virtual ~Session() = default;

    /// Clears state that is carried from frame to frame; the next frame is the first again.
    void reset() {
        is_placed_ = !first_frame_places_;
        do_reset();
    }
    /// Finds the candidate pairs of the frame and their contacts, and waits for their numbers. The session
    /// finds the body pairs, according to setting broad; on the device for frames in its memory.
    /// With motion=linear, the view needs the frame's successor: the pairs are those that could meet while
    /// the bodies move from one to the other. Deformable vertices move on straight lines. Rigid bodies
    /// translate on straight lines and rotate by the shorter angle at constant speed. Contacts are those of
    /// the frame. A frame in the memory of the only device gives the bits of the same frame in the host's
    /// memory. With origin=auto and no Scene::frame, the host downloads the first one, once. Throws
    /// InputError, unless the view is checked, for a frame that does not pass check_frame
    /// (bodies/check_input.h), and always for a successor without motion=linear or the reverse. For frames in
    /// a device's memory it throws InputError if a buffer is missing or too small, if coordinates do not pass
    /// check_range or a rotation has zero length, and if the host needs the numbers: with several devices,
    /// residency=published, placement=exact, or a device without double.
    FrameResult run(const FrameView& frame) { return run_among(frame, std::nullopt); }
    /// The same for these body pairs, at most 2^32 - 1; with motion=linear all that could meet on the way.
    /// Throws InputError for a pair with a body that the scene lacks, unless the view is checked, and for a
    /// pair of a body with itself unless setting self allows such pairs.
    FrameResult run(const FrameView& frame, std::span<const BodyPair> body_pairs) {
        return run_among(frame, body_pairs);
    }
    /// Enqueues the commands of a frame without waiting for them. Buffers keep their capacities, those of the
    /// settings or those to which earlier run() have grown them; a frame that exceeds them is flagged
    /// (QueuedFrame::counts), and run() of the same frame finds the whole answer. So are frames in device
    /// memory with rows out of range. A later frame overwrites the answer. The first call, and the first
    /// after a run() that has grown buffers, prepares: it allocates, may wait, and throws what run() throws
    /// for rows out of range. On CUDA later calls with a frame in device memory may be captured in the
    /// caller's graph, which replays with what the same arrays then contain. Throws InputError as run(), and
    /// where the host takes part in a frame: several devices, residency=published, decision=exact, or a walk
    /// that needs it; and for a captured frame in the host's memory.
    QueuedFrame enqueue(const FrameView& frame) { return enqueue_among(frame, std::nullopt); }
    /// The same for these body pairs, as with run().
    QueuedFrame enqueue(const FrameView& frame, std::span<const BodyPair> body_pairs) {
        return enqueue_among(frame, body_pairs);
    }
    /// Waits, and returns the answer of the last frame enqueued; nullopt if it is flagged. Throws InputError
    /// if none was enqueued since a run() that has grown buffers.
    std::optional<FrameResult> collect() {
        auto result = do_collect();
        return result ? std::optional(finished(*std::move(result))) : std::nullopt;
    }
    /// Switches to kernels that count their work and make no contacts, or back. Such runs are never timed.
    void count_work(bool on) { do_count_work(on); }
    /// The devices of this process; valid as long as the session.
    std::span<Device* const> devices() const { return do_devices(); }
    /// The bodies whose states frames need in this process, in any order; nullopt: all bodies. On ranks of a
    /// job these are the rank's own bodies, which change when FrameResult::repartitions is 1.
    std::optional<std::span<const std::uint32_t>> owned() const { return do_owned(); }
    /// The settings after Traversal::fitted.
    const Settings& settings() const { return do_settings(); }
    /// Origin of the coordinates on the devices, by setting origin. With origin=auto in a scene without
    /// Scene::frame, the first frame that runs fixes it, and after reset() the next one.
    const Eigen::Vector3d& origin() const { return origin_; }
    /// What the kernels of the last run read, in memory of the only device, relative to origin(). Null for
    /// sessions that do not run frames in the device's memory.
    const Bodies* bodies() const { return do_bodies(); }

protected:
    /// Throws the InputError of a captured frame before enqueue() has prepared.
    [[noreturn]] static void refuse_capture();
    /// As collect(). Throws InputError unless a session overrides it.
    virtual std::optional<FrameResult> do_collect();

private:
    friend class Traversal; // calls begin_at
    /// Sets scene and origin of a new session. `centred`: what the devices have in place of the scene; null:
    /// the same.
    void begin_at(const Scene& scene, std::shared_ptr<const Scene> centred);
    /// Takes the origin of the first frame, unless it is fixed.
    void place(const Frame& frame);
    /// Called in every run, because sessions may share a device with other settings.
    void set_threads() const;
    void check_pairs(std::optional<std::span<const BodyPair>> body_pairs, bool checked) const;
    void check_motion(bool has_next) const;
    void check_frames(const FrameInput& input) const;
    void check_call(const FrameView& view, std::optional<std::span<const BodyPair>> body_pairs) const;
    FrameResult run_among(const FrameView& view, std::optional<std::span<const BodyPair>> body_pairs);
    QueuedFrame enqueue_among(const FrameView& view, std::optional<std::span<const BodyPair>> body_pairs);
    /// Calls `work` with the frame as the devices have it.
    template<class Work>
    auto with_host_input(const FrameInput& input, const Work& work);
    template<class Work>
    auto with_device_input(const DeviceFrameInput& input, const Work& work);
    /// The frame as the devices have it: relative to the origin, and to the middles of centred meshes.
    Frame as_on_devices(const Frame& frame) const;
    /// Completes a frame's result, checks the devices' guards, and fixes the origin.
    FrameResult finished(FrameResult result);

    virtual void do_reset() = 0;
    /// Called before a frame with another origin than the last: what earlier frames left on the devices is
    /// relative to that.
    virtual void do_move_origin() {}
    /// `input` has a successor with motion=linear only, which skips the same tetrahedra.
    virtual FrameResult do_run(const FrameInput& input,
                               std::optional<std::span<const BodyPair>> body_pairs) = 0;
    /// Runs a checked frame in the device's memory. Throws InputError unless a session overrides it.
    virtual FrameResult do_run_device_input(const DeviceFrameInput& input,
                                            std::optional<std::span<const BodyPair>> body_pairs);
    /// Throws InputError unless a session overrides it. One of the two frames is null.
    virtual QueuedFrame do_enqueue(const FrameInput* host, const DeviceFrameInput* device,
                                   std::optional<std::span<const BodyPair>> body_pairs);
    virtual void do_count_work(bool on) = 0;
    virtual std::span<Device* const> do_devices() const = 0;
    virtual const Settings& do_settings() const = 0;
    virtual std::optional<std::span<const std::uint32_t>> do_owned() const { return std::nullopt; }
    virtual const Bodies* do_bodies() const { return nullptr; }

    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
    bool first_frame_places_ = false;       ///< the first frame decides the origin
    bool is_placed_ = true;                 ///< the origin is fixed until reset()
    const Scene* scene_ = nullptr;          ///< the argument of prepare()
    std::vector<std::uint32_t> deformable_; ///< its deformable bodies
    std::shared_ptr<const Scene> centred_;  ///< what the devices have in its place; null: the same
};

/// The settings with the contact rule and the decision to rely on, where neither is given.
SettingTexts with_reliable_contacts(SettingTexts given);
/// With the contact rule that output=distances needs, unless another is given.
SettingTexts with_rule_of_output(SettingTexts given);

/// A way to find candidate pairs. Stateless; added by one line in list.cpp.
class Traversal {
public:
    virtual ~Traversal() = default;

    virtual std::string_view name() const = 0;    ///< in options and records; unique
    virtual std::string_view summary() const = 0; ///< short description for listings
    /// The settings that it has, its own and common ones; valid as long as the algorithm.
    virtual std::span<const Parameter* const> parameters() const = 0;
    /// At least one preset. Tests and tables use the first if none is named.
    virtual std::span<const Preset> presets() const = 0;
    /// The counters of its walks.
    virtual std::span<const Counter> counters() const = 0;

    /// Settings by name, over those of a preset; empty: the first preset. Unless given, contacts are those to
    /// rely on: contact_rule=sat and decision=usual. A preset that reproduces a program of others
    /// (Preset::reproduces) keeps the paper's `opposing`, as all presets of `tandem run` do. Throws
    /// InputError for an unknown name or value, which it names.
    Settings settings(const SettingTexts& given = {}, std::string_view preset = {}) const;

    /// Adapts settings to a device, such as to groups of one work-item if it has no larger ones. `scene`: the
    /// scene of the session; if null, settings that depend on it are unchanged. Throws InputError if resolved
    /// settings are incompatible with each other or with the device.
    Settings fitted(const Settings& settings, const DeviceInfo& info, const Scene* scene = nullptr) const;
    /// Throws InputError if resolved settings are incompatible with each other or with one of the devices, or
    /// if the algorithm cannot split a frame between several devices with them.
    void check(std::span<Device* const> devices, const Settings& settings) const;

    /// Makes a session from resolved settings. Several devices split the body pairs of a frame. `scene` and
    /// `devices` must outlive the session and its results. Throws InputError or DeviceError.
    std::unique_ptr<Session> prepare(std::span<Device* const> devices, const Scene& scene,
                                     const Settings& settings) const;

    /// Makes a session on the ranks of a job, each with its own device. All ranks together call this, run()
    /// and reset(). Each rank owns a subdomain and exchanges ghost bodies, and exactly one rank finds each
    /// pair. A frame needs the rank's own bodies and fixed bodies. The result has the pairs of this rank, and
    /// in `shared` the work of each rank. The device stores only bodies that the rank needs. An error on one
    /// rank is thrown on all ranks, with its number. `ranks` must outlive the session.
    std::unique_ptr<Session> prepare(Device& device, const Scene& scene, const Settings& settings,
                                     Ranks& ranks) const;

    /// The cost models, by entry point, of all kernels of a frame with these fitted settings (bodies/cost.h).
    std::vector<KernelCost> costs(const Scene& scene, const Settings& settings) const;

    /// Builds the algorithm's own stages of a frame, for pipelines. Throws OutOfMemory or DeviceError.
    AlgorithmStages build(const BuildContext& context) const;

private:
    /// Resolves the algorithm's own settings that depend on the device and the scene, which may be null.
    virtual void do_fit(Settings& settings, const DeviceInfo& info, const Scene* scene) const;
    /// Throws InputError if the algorithm's own settings do not fit the device or each other.
    virtual void do_check(const Settings& settings, const DeviceInfo& info) const = 0;
    virtual AlgorithmStages do_build(const BuildContext& context) const = 0;
    /// The cost models of its own kernels; by default none.
    virtual std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const;
};

/// Every algorithm of the project except baselines, followed by those of add_algorithm.
std::span<const Traversal* const> algorithms();

/// Walks of other projects, for comparison in the same record. They are opt-in by name, because each supports
/// some settings and devices only.
std::span<const Traversal* const> baselines();

/// Adds an algorithm of an application to the list. `traversal` must live as long as the program. Not
/// thread-safe. Throws InputError if the name exists.
void add_algorithm(const Traversal& traversal);

/// The algorithm or baseline of that name. Throws InputError that names the nearest.
const Traversal& algorithm(std::string_view name);

/// The preset of that name. Throws InputError.
const Preset& preset(const Traversal& traversal, std::string_view name);

/// The name of a method in tables, messages and pages: the preset's title, or "algorithm preset" without one.
std::string title_of(const Traversal& traversal, const Preset& preset);

} // namespace tandem
