// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "harness/device_groups.h"
#include "python/core/arrays.h"

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
};

/// A scene of meshes on devices of its own, prepared for one algorithm. One thread at a time is in it.
class Collider {
public:
    /// Throws InputError or DeviceError.
    Collider(std::vector<Mesh> meshes, const ColliderOptions& options);

    /// Finds the pairs of a frame; without poses every body is at the identity, and deformable ones without
    /// vertices have their mesh's. Throws InputError or DeviceError.
    /// Seconds: of the frame itself, as the program measures one.
    std::pair<FrameResult, double> run(const std::optional<Poses>& poses,
                                       const std::vector<std::optional<Points>>& vertices);
    void reset();

    std::size_t bodies() const { return scene_.bodies.size(); }
    const Settings& settings() const { return session_->settings(); }
    const DeviceGroup& devices() const { return devices_; }
    /// Around every use of its devices, answers' included. Taken without the interpreter's lock.
    std::mutex& mutex() { return mutex_; }

private:
    void set_poses(const Poses& poses);
    void set_vertices(std::size_t body, const Points& vertices);
    void check_coordinates() const;

    std::vector<BackendReport> backends_; ///< these outlive what lies on their devices
    DeviceGroup devices_;
    Scene scene_;
    Frame frame_; ///< the last one's memory serves the next
    std::unique_ptr<Session> session_;
    std::mutex mutex_;
};

/// Adds Collider and algorithms().
void bind_collider(nanobind::module_& module);

} // namespace tandem::python
