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

/// What a collider is made of. Bodies have one entry in each list that is about them.
struct ColliderOptions {
    std::vector<std::uint32_t> bodies; ///< the mesh of each
    std::vector<bool> deformable;
    std::string algorithm, preset, device;
    SettingTexts settings;
    std::optional<std::uintptr_t>
        stream; ///< a CUstream of the device, which is one of CUDA's; 0: the default one
};

/// A frame's numbers: without poses every body is at the identity, and deformable ones without vertices have
/// their mesh's.
struct Input {
    std::optional<GivenRows> poses;
    std::vector<std::optional<GivenRows>> vertices; ///< one a body, or none at all
    bool there = false; ///< some of them are in memory of the collider's device, and it is read there
};

/// A scene of meshes on devices of its own, prepared for one algorithm. One thread at a time is in it.
class Collider {
public:
    /// Throws InputError or DeviceError.
    Collider(std::vector<Mesh> meshes, const ColliderOptions& options);

    /// Finds the pairs of a frame. Throws InputError or DeviceError.
    /// Seconds: of the frame itself, as the program measures one.
    std::pair<FrameResult, double> run(const Input& input);
    /// Of algorithm auto: the fastest of its candidates for that frame runs from now on. Throws InputError
    /// for another algorithm.
    std::vector<Trial> tune(const Input& input, double seconds);
    void reset();

    std::size_t bodies() const { return scene_.bodies.size(); }
    bool is_deformable(std::size_t body) const { return scene_.bodies[body].deformable; }
    bool is_any_deformable() const {
        return std::ranges::any_of(scene_.bodies, [](const Body& body) { return body.deformable; });
    }
    /// "auto" until one is chosen.
    std::string algorithm();
    /// As the devices took them; none until an algorithm is chosen.
    SettingTexts setting_texts();
    /// The same of a collider that has run, with its lock.
    const Settings& settings() const { return session_->settings(); }
    const DeviceGroup& devices() const { return devices_; }
    /// Where kernels read the last frame that was in memory of the device.
    std::vector<std::uintptr_t> addresses();
    /// Whose stream its commands go by: lives as long as the devices.
    void keep(nanobind::object owner) { kept_ = std::move(owner); }
    /// Around every use of its devices, answers' included. Taken without the interpreter's lock.
    std::mutex& mutex() { return mutex_; }

private:
    void open_devices(const ColliderOptions& options);
    void prepare(const ColliderOptions& options);
    /// A frame of the input, checked and ready to run; the next one's takes its place.
    const Frame& host_frame(const Input& input);
    const DeviceFrame& device_frame(const Input& input);
    template<class AnyFrame>
    std::pair<FrameResult, double> run_frame(const AnyFrame& frame);
    template<class AnyFrame>
    std::vector<Trial> choose_for(const AnyFrame& frame, double seconds);
    void set_poses(const GivenRows& poses);
    void set_vertices(std::size_t body, const GivenRows& vertices);

    nanobind::object kept_;
    std::vector<BackendReport> backends_; ///< these outlive what lies on their devices
    DeviceGroup devices_;
    Scene scene_;
    std::string algorithm_;
    std::vector<Cell> candidates_; ///< of auto
    Precision precision_ = Precision::fp32;
    double limit_ = 0;       ///< of coordinates
    Frame frame_;            ///< the last one's memory serves the next
    std::size_t beyond_ = 0; ///< coordinates of it that are out of range
    std::unique_ptr<DeviceInput> device_input_;
    std::unique_ptr<Session> session_; ///< none until an algorithm is chosen
    std::mutex mutex_;
};

/// Adds Collider and algorithms().
void bind_collider(nanobind::module_& module);

} // namespace tandem::python
