// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/kdop/device_scene.h"
#include "algorithms/settings.h"
#include "backends/device.h"
#include "scenes/contact.h"
#include "scenes/scene.h"

#include <memory>
#include <optional>
#include <span>

namespace tandem {

/// Order-free digest of a set: its 64-bit count and two wrapping sums of a fixed mix of its elements.
struct Digest {
    std::uint64_t count = 0, a = 0, b = 0;

    bool operator==(const Digest&) const = default;
};

/// What a walk did, from a counting build that is never timed.
struct Work {
    std::uint64_t bvtt_nodes = 0;  ///< node pairs tested
    std::uint64_t seeds = 0;       ///< node pairs the walks started from
    std::uint64_t balances = 0;    ///< balance launches that moved work
    std::uint64_t refills = 0;     ///< times a group loaded more from its queue inside a launch
    std::uint64_t spills = 0;      ///< node pairs that left a full local queue for the global one
    std::uint64_t queue_bytes = 0; ///< gproximity: one array of queues
    std::uint64_t published_queue_bytes =
        0; ///< what the paper's release would have made of it on this device
};

/// A frame's answer. The pairs lie in a buffer of the device until the next run.
struct FrameResult {
    Buffer pairs; ///< rows of 4 words as pairs.clh lists them; empty unless output = pairs
    std::uint64_t count = 0;
    std::uint64_t capacity = 0;
    std::uint64_t body_pairs = 0; ///< those given, or found on the device
    std::uint64_t contacts = 0;
    std::uint64_t degenerate = 0; ///< pairs without contacts because a tetrahedron has no volume
    std::uint64_t rejected = 0;   ///< pairs that a separating axis told apart
    std::uint64_t unsure = 0;     ///< pairs the certified filter could not decide (decision=recheck, exact)
    std::uint64_t uncertain = 0;  ///< pairs double could not decide either (decision=recheck, fp64, exact)
    std::uint64_t retries = 0;    ///< times a buffer was too small and the walk ran again
    std::optional<Digest> digest; ///< output = digest: of the pairs; otherwise ask Session::digest
    Work work;                    ///< zero unless Session::count_work(true)
};

/// A scene prepared on a device for one algorithm and one set of settings: uploaded and compiled. Everything
/// that run() does is measured; everything before is not.
class Session {
public:
    virtual ~Session() = default;

    /// Forgets what was carried from frame to frame.
    virtual void reset() = 0;
    /// Whether the session finds the body pairs of a frame itself (broad = device).
    virtual bool finds_pairs() const = 0;
    /// Finds the candidate pairs of `frame` among `pairs`, and their contacts. Waits until they are known.
    /// Coordinates must pass check_range (kdop/range.h). A session that finds_pairs() takes no `pairs` and
    /// throws InputError when it is given some.
    virtual FrameResult run(const Frame& frame, std::span<const BodyPair> pairs) = 0;
    /// Digests of the last frame's pairs and contacts, summed where they are. Not part of a measured frame.
    virtual Digest digest(const FrameResult& result) = 0;
    virtual Digest contact_digest(const FrameResult& result) = 0;
    /// The last frame's pairs and contacts, sorted.
    virtual std::vector<Pair> download(const FrameResult& result) = 0;
    virtual std::vector<ContactPoint> download_contacts(const FrameResult& result) = 0;
    /// Switches to kernels that count their work (and back); such runs are never timed.
    virtual void count_work(bool on) = 0;
    virtual Device& device() = 0;
    /// The resolved settings as this device took them.
    virtual const Settings& settings() const = 0;
};

/// A way to find candidate pairs. Stateless; added by one line in list.cpp.
class Traversal {
public:
    virtual ~Traversal() = default;

    virtual std::string_view name() const = 0;
    virtual std::string_view summary() const = 0;
    virtual std::span<const Parameter> parameters() const = 0;
    virtual std::span<const Preset> presets() const = 0;

    /// Throws InputError when resolved settings do not fit each other or the device.
    void check(const Settings& settings, const DeviceInfo& info) const { do_check(settings, info); }

    /// `settings` are resolved ones. Throws InputError or DeviceError. Sessions on several devices at once
    /// are not there yet: `devices` holds one.
    std::unique_ptr<Session> prepare(std::span<Device* const> devices, const Scene& scene,
                                     const Settings& settings) const;

private:
    virtual void do_check(const Settings& settings, const DeviceInfo& info) const = 0;
    virtual std::unique_ptr<Session> do_prepare(Device& device, const Scene& scene,
                                                const Settings& settings) const = 0;
};

/// Every algorithm of the project.
std::span<const Traversal* const> algorithms();

/// The one of that name; throws InputError that names the nearest.
const Traversal& algorithm(std::string_view name);

/// Its preset of that name ("default" has no values); throws InputError.
const Preset& preset(const Traversal& traversal, std::string_view name);

} // namespace tandem
