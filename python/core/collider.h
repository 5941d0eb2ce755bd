// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "harness/plans/device_groups.h"
#include "python/core/choosing.h"
#include "python/core/device_input.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>

namespace tandem::python {

/// Options of a collider. `bodies`, `deformable` and `groups` have one entry per body.
struct ColliderOptions {
    std::vector<std::uint32_t> bodies; ///< number of each body's mesh
    std::vector<bool> deformable;
    std::string algorithm, preset, device;
    SettingTexts settings;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> groups;     ///< Body::groups, Body::meets
    std::vector<std::pair<std::uint32_t, std::uint32_t>> never_meet; ///< in any order
    std::optional<std::uintptr_t> stream; ///< a CUstream of the device, a CUDA one; 0: default stream
};

/// Arrays of one frame. Without poses every body has the identity. Deformable bodies without vertices have
/// those of their mesh.
struct Input {
    std::optional<GivenRows> poses;
    std::vector<std::optional<GivenRows>> vertices; ///< one per body, or empty
    bool on_device = false; ///< whether kernels read some of the arrays in memory of the collider's device
};

/// A scene of meshes on its own devices, prepared for one algorithm. One thread at a time uses it.
class Collider {
public:
    /// Throws InputError or DeviceError.
    Collider(std::vector<Mesh> meshes, const ColliderOptions& options);

    /// Finds the pairs of a frame. Returns the result and the seconds of the frame itself, measured as the
    /// program does. Throws InputError or DeviceError.
    std::pair<FrameResult, double> run(const Input& input);
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
    /// Keeps the Python object that owns the stream alive as long as the devices.
    void set_stream_owner(nanobind::object owner) { stream_owner_ = std::move(owner); }
    /// Guards every use of the devices, also by answers. Release the interpreter's lock before locking it.
    std::mutex& mutex() { return mutex_; }

private:
    void open_devices(const ColliderOptions& options);
    void prepare(const ColliderOptions& options);
    /// The input as a checked frame. The next call overwrites it.
    const Frame& host_frame(const Input& input);
    const DeviceFrame& device_frame(const Input& input);
    template<class AnyFrame>
    std::pair<FrameResult, double> run_frame(const AnyFrame& frame);
    template<class AnyFrame>
    std::vector<Trial> choose_for(const AnyFrame& frame, double seconds);
    void set_poses(const GivenRows& poses);
    void set_vertices(std::size_t body, const GivenRows& vertices);

    nanobind::object stream_owner_;
    std::vector<BackendReport> backends_; ///< declared first, so that devices outlive their buffers
    DeviceGroup devices_;
    Scene scene_;
    std::string algorithm_;
    std::vector<Cell> candidates_; ///< candidates of algorithm auto
    Precision precision_ = Precision::fp32;
    double limit_ = 0;             ///< largest valid coordinate
    Frame frame_;                  ///< its memory is reused for each frame
    std::size_t out_of_range_ = 0; ///< number of coordinates of frame_ beyond limit_
    std::unique_ptr<DeviceInput> device_input_;
    std::unique_ptr<Session> session_; ///< null until an algorithm is chosen
    std::mutex mutex_;
};

/// Adds Collider and algorithms().
void bind_collider(nanobind::module_& module);

} // namespace tandem::python
