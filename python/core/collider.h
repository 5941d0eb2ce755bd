// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "harness/plans/cells.h"
#include "harness/verify/oracle/world.h"
#include "python/core/device_input.h"
#include "python/core/host_input.h"
#include "python/core/process.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>

namespace tandem::python {

/// A timed candidate of algorithm="auto".
struct Trial {
    std::string algorithm;
    SettingTexts changes; ///< settings that differ from its preset
    double seconds = 0;   ///< median time of a frame
};

/// Options of a collider. `bodies`, `deformable` and `groups` have one entry per body.
struct ColliderOptions {
    std::vector<std::uint32_t> bodies; ///< number of each body's mesh
    std::vector<bool> deformable;
    std::string algorithm, preset, device;
    SettingTexts settings;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> groups;     ///< Body::groups, Body::meets
    std::vector<std::pair<std::uint32_t, std::uint32_t>> never_meet; ///< in any order
    std::size_t worlds = 1;               ///< divides the bodies; those of a world follow each other
    std::optional<std::uintptr_t> stream; ///< a CUstream of the device, a CUDA one; 0: default stream
};

/// One run of a collider.
struct CollideRun {
    FrameResult result;
    double seconds = 0;                 ///< of the frame itself, measured as the program does
    std::shared_ptr<const Frame> frame; ///< null if it was in memory of the device
    std::uint64_t number = 0;           ///< counts frames of the collider
};

/// A scene of meshes on its own devices, prepared for one algorithm. One thread at a time uses it.
class Collider {
public:
    /// Throws InputError or DeviceError.
    Collider(std::vector<Mesh> meshes, const ColliderOptions& options);
    Collider(const Collider&) = delete;
    Collider& operator=(const Collider&) = delete;
    ~Collider();

    /// Finds the pairs of a frame, with motion=linear up to its successor. Throws InputError, DeviceError
    /// also in a forked process, or what the handler of a signal raises (signals.h).
    CollideRun run(const Input& input);
    /// Enqueues a frame without waiting for it, in the order of `stream`, or of the stream of its arrays.
    /// Returns its number, too. Throws as run(), and InputError where the host takes part in frames
    /// (Session::enqueue).
    std::pair<QueuedFrame, std::uint64_t> enqueue(const Input& input, std::optional<void*> stream);
    /// Throws InputError if a later frame of enqueue() has overwritten frame `number`. Needs the lock.
    void check_queued(std::uint64_t number) const;
    /// Session::collect() of frame `number`. Throws as check_queued().
    std::optional<CollideRun> collect(std::uint64_t number);
    /// Algorithm auto: times the candidates on that frame and selects the fastest for later runs. Throws
    /// InputError for another algorithm.
    std::vector<Trial> tune(const Input& input, double seconds);
    void reset();

    std::size_t bodies() const { return scene_.bodies.size(); }
    bool is_deformable(std::size_t body) const { return scene_.bodies[body].deformable; }
    bool is_any_deformable() const {
        return std::ranges::any_of(scene_.bodies, [](const Body& body) { return body.deformable; });
    }
    /// "auto" until an algorithm is chosen.
    std::string algorithm();
    /// Settings in use, after the devices' adjustments; empty until an algorithm is chosen.
    SettingTexts setting_texts();
    /// The same. Needs a collider that has run, and its lock.
    const Settings& settings() const { return session_->settings(); }
    const DeviceGroup& devices() const { return devices_; }
    /// Addresses from which kernels read the last frame that was in memory of the device.
    std::vector<std::uintptr_t> addresses();
    /// Corners of the frame of run `number` in memory of the device, as kernels had them, by a download.
    /// Needs the lock. Throws InputError if a later run has overwritten them.
    oracle::World world_of(std::uint64_t number, const char* asks) const;
    /// Keeps the Python object that owns the stream alive as long as the devices.
    void set_stream_owner(nanobind::object owner) { stream_owner_ = std::move(owner); }
    /// Guards every use of the devices, also by answers. Release the interpreter's lock before the call.
    /// Throws DeviceError in a forked process, unless all devices are the host, and InputError in a signal's
    /// handler that a run of this thread has called.
    std::unique_lock<std::recursive_mutex> lock();
    /// The same for the end of an answer, at any time: with the interpreter's lock, also within a run.
    std::unique_lock<std::recursive_mutex> lock_at_end();
    /// Whether the devices are lost, because a fork made this process. Objects in their memory must then
    /// leak.
    bool is_lost() const { return is_forked() && has_runtime(devices_); }
    const Scene& scene() const { return scene_; }
    /// Why nothing can meet in any frame, for messages; empty if something may.
    const std::string& nothing_meets() const { return nothing_meets_; }

private:
    void open_devices(const ColliderOptions& options);
    void prepare(const ColliderOptions& options);
    /// Throws InputError for a wrong number of rows, unless there is a successor exactly with
    /// motion=linear, and for an update without a frame in host memory.
    void check(const Input& input) const;
    void check_update(const Input& input) const;
    /// A checked input as frames. The next call overwrites them.
    FrameInput host_frames(const Input& input);
    DeviceFrameInput device_frames(const Input& input);
    /// The result of `work`, which a signal may end.
    template<class Work>
    auto with_signals(const Work& work);
    template<class Frames>
    FrameResult run_frame(Session& session, const Frames& frames,
                          const std::optional<std::vector<BodyPair>>& given);
    template<class Frames>
    CollideRun run_frames(const Frames& frames, const std::optional<std::vector<BodyPair>>& body_pairs);
    template<class Frames>
    std::vector<Trial> choose_for(const Frames& frames, double seconds);

    nanobind::object stream_owner_;
    std::vector<BackendReport> backends_; ///< declared first, so that devices outlive their buffers
    DeviceGroup devices_;
    Scene scene_;
    std::string algorithm_, nothing_meets_;
    std::vector<Cell> candidates_; ///< candidates of algorithm auto
    Geometry geometry_;
    Motion motion_ = Motion::none;
    std::optional<HostInput> host_input_, next_host_input_; ///< of frames, and of their successors
    std::optional<DeviceInput> device_input_;
    std::uint64_t frames_ = 0;         ///< number of frames that sessions began to run
    std::uint64_t last_queued_ = 0;    ///< that of the last frame of enqueue()
    bool is_last_on_device_ = false;   ///< whether the last frame was in memory of the device
    std::unique_ptr<Session> session_; ///< null until an algorithm is chosen
    std::recursive_mutex mutex_;
    bool runs_ = false; ///< a call works on the devices; under mutex_
};

/// Adds Collider and algorithms().
void bind_collider(nanobind::module_& module);

} // namespace tandem::python
