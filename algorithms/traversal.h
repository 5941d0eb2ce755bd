// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"
#include "algorithms/device_frame.h"
#include "algorithms/parameters/parameter.h"
#include "backends/device.h"
#include "scenes/scene.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace tandem {

class Ranks;         // backends/ranks.h
struct BuildContext; // steps.h
struct KernelCost;   // cost.h
struct AlgorithmStages;

/// Two bodies whose volumes may overlap; a < b.
struct BodyPair {
    std::uint32_t a = 0;
    std::uint32_t b = 0;

    auto operator<=>(const BodyPair&) const = default;
};

/// A scene prepared on its devices for one algorithm and one set of settings: uploaded and compiled.
/// Everything that run() does is measured; everything before is not. Every function may throw DeviceError;
/// after one the session can be used again.
class Session {
public:
    virtual ~Session() = default;

    /// Forgets what was carried from frame to frame.
    void reset() { do_reset(); }
    /// Finds the candidate pairs of `frame` and their contacts, and waits until they are known. Coordinates
    /// must pass check_range (bodies/range.h). Body pairs are found inside, as setting broad says.
    FrameResult run(const Frame& frame);
    /// The same among these body pairs, of which there may be 2^32 - 1.
    FrameResult run(const Frame& frame, std::span<const BodyPair> body_pairs);
    /// The same of a frame whose numbers are in memory of the session's one device, where kernels read them:
    /// with the same bits, the answer of the same frame in the host's memory. Body pairs that are not given
    /// are found on the device, whatever broad says. Throws InputError where a buffer is missing or too
    /// small, for coordinates that do not pass check_range and rotations of no length (the sentences of the
    /// host's memory), and where the host needs the numbers: several devices, residency=published,
    /// placement=exact, a device without double.
    FrameResult run(const DeviceFrame& frame);
    FrameResult run(const DeviceFrame& frame, std::span<const BodyPair> body_pairs);
    /// Switches to kernels that count their work and make no contacts (and back); such runs are never timed.
    void count_work(bool on) { do_count_work(on); }
    std::span<Device* const> devices() const { return do_devices(); }
    /// The bodies that frames have to have from this process, in no order: of a session on ranks of a job its
    /// own ones, until FrameResult::repartitions says that they are others; nothing: all of them.
    std::optional<std::span<const std::uint32_t>> owned() const { return do_owned(); }
    /// The settings as the devices took them.
    const Settings& settings() const { return do_settings(); }
    /// What coordinates on the devices count from, by setting origin.
    const Eigen::Vector3d& origin() const { return origin_; }

private:
    friend class Traversal; // which knows the scene
    /// Other sessions may have used the devices otherwise.
    void set_threads() const;
    FrameResult run_among(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs);
    FrameResult run_among(const DeviceFrame& frame, std::optional<std::span<const BodyPair>> body_pairs);
    /// A frame's result, completed, after a check of the devices' guards.
    FrameResult finished(FrameResult result) const;

    virtual void do_reset() = 0;
    virtual FrameResult do_run(const Frame& frame, std::optional<std::span<const BodyPair>> body_pairs) = 0;
    /// Of a checked frame; refuses unless a session knows how.
    virtual FrameResult do_run_device_input(const DeviceFrame& frame,
                                            std::optional<std::span<const BodyPair>> body_pairs);
    virtual void do_count_work(bool on) = 0;
    virtual std::span<Device* const> do_devices() const = 0;
    virtual const Settings& do_settings() const = 0;
    virtual std::optional<std::span<const std::uint32_t>> do_owned() const { return std::nullopt; }

    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
    const Scene* scene_ = nullptr; ///< as prepare() was given it
};

/// Something that an algorithm counts about its work, by name.
struct Counter {
    enum class Total { sum, last }; ///< over frames

    std::string_view name;
    std::string_view unit;    ///< "bytes", or of what there are so many
    std::string_view meaning; ///< one line
    Total total = Total::sum;
};

/// Work-groups that kernels are launched with.
struct LaunchShape {
    std::uint32_t group_size = 1; ///< work-items per group
    std::uint32_t groups = 1;     ///< of kernels that stride
};

/// A way to find candidate pairs. Stateless; added by one line in list.cpp.
class Traversal {
public:
    virtual ~Traversal() = default;

    virtual std::string_view name() const = 0;
    virtual std::string_view summary() const = 0;
    virtual std::span<const Parameter* const> parameters() const = 0;
    /// One at least; the first is what tests and tables take where none is named.
    virtual std::span<const Preset> presets() const = 0;
    /// What its walks count.
    virtual std::span<const Counter> counters() const = 0;

    /// The settings as a device takes them: groups have one work-item where it knows no larger ones. `scene`:
    /// the session's; without one, what depends on it stays as it is. Throws InputError when resolved
    /// settings do not fit each other or the device.
    Settings fitted(const Settings& settings, const DeviceInfo& info, const Scene* scene = nullptr) const;
    /// Throws InputError when resolved settings do not fit each other or one of the devices, or when there
    /// are several and the algorithm cannot split a frame with these settings.
    void check(std::span<Device* const> devices, const Settings& settings) const;

    /// `settings` are resolved ones; several devices share a frame's body pairs. `scene` and `devices` must
    /// outlive the session and its results. Throws InputError or DeviceError.
    std::unique_ptr<Session> prepare(std::span<Device* const> devices, const Scene& scene,
                                     const Settings& settings) const;

    /// The same on ranks of a job, which all call it together, each with a device of its own; run() and
    /// reset() of the session too. Ranks own bodies, tell each other where those are that come near, and each
    /// pair is found by one of them. Of a frame a rank gives those that it owns, and fixed bodies; its result
    /// has what it found itself, and in `shared` what each rank did. On its device are only bodies that it
    /// needs. An error of one rank is thrown on all, with its number. `ranks` must outlive the session.
    std::unique_ptr<Session> prepare(Device& device, const Scene& scene, const Settings& settings,
                                     Ranks& ranks) const;

    /// What each kernel of a frame with these settings, as a device took them, has to move and to compute at
    /// least: its own and those of every algorithm, by entry point (cost.h).
    std::vector<KernelCost> costs(const Scene& scene, const Settings& settings) const;

    /// Its own steps of a frame; for pipelines. Throws OutOfMemory or DeviceError.
    AlgorithmStages build(const BuildContext& ground) const;

private:
    /// Decides what its own settings leave to the device and the scene, which may be null.
    virtual void do_fit(Settings& settings, const DeviceInfo& info, const Scene* scene) const;
    /// Throws InputError when the algorithm's own settings do not fit.
    virtual void do_check(const Settings& settings, const DeviceInfo& info) const = 0;
    virtual AlgorithmStages do_build(const BuildContext& ground) const = 0;
    /// Those of its own kernels; none where nothing is said of them.
    virtual std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const;
};

/// Every algorithm of the project but its peers, then those added by add_algorithm.
std::span<const Traversal* const> algorithms();

/// Other projects' walks, for comparison in the same record. They are had by name: each does a part only of
/// what settings and devices there are, and refuses the rest, so that no list of all algorithms has them.
std::span<const Traversal* const> baselines();

/// Adds one to the list, for programs that bring their own; `traversal` must live as long as the program.
/// Not thread-safe. Throws InputError when there is one of that name.
void add_algorithm(const Traversal& traversal);

/// The one of that name, peers included; throws InputError that names the nearest.
const Traversal& algorithm(std::string_view name);

/// Its preset of that name; throws InputError.
const Preset& preset(const Traversal& traversal, std::string_view name);

} // namespace tandem
