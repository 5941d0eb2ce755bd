// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/subdomain.h"
#include "backends/device.h"
#include "scenes/scene.h"

namespace tandem {

/// A hierarchy over the tetrahedra of every body, refitted every frame. An algorithm creates its walk and its
/// hierarchy together, so the walk uses the concrete type.
class Hierarchy {
public:
    virtual ~Hierarchy() = default;
    Hierarchy() = default;
    Hierarchy(const Hierarchy&) = delete;
    Hierarchy& operator=(const Hierarchy&) = delete;

    /// Enqueues the refit of all bounds of `frame` from the vertices and poses on the device. Tetrahedra that
    /// the frame skips are in no bound. Fixed bodies keep their bounds unless `all` is set. Throws
    /// DeviceError.
    void refit(const Frame& frame, bool all = false) { do_refit(frame, all); }
    /// Limits later refits to bodies with a role in `subdomain`; the next one includes fixed bodies. The
    /// bounds of all other bodies become invalid. Throws DeviceError.
    void take(const Subdomain& subdomain, std::size_t bodies) {
        roles_ = roles_of(subdomain, bodies);
        do_take(subdomain);
    }

    /// The k-DOP of every body after the last refit, K reals each (volume.clh).
    const Buffer& volumes() const { return do_volumes(); }
    /// The nodes, K reals each. A session that keeps nothing on the device transfers these.
    const Buffer& nodes() const { return do_nodes(); }
    /// Bytes of device memory in all buffers.
    std::size_t bytes() const { return do_bytes(); }

protected:
    bool is_active(std::uint32_t body) const { return roles_.empty() || roles_[body] != Role::none; }

private:
    virtual void do_refit(const Frame& frame, bool all) = 0;
    virtual const Buffer& do_volumes() const = 0;
    virtual const Buffer& do_nodes() const = 0;
    virtual std::size_t do_bytes() const = 0;
    /// The default keeps refitting all bodies.
    virtual void do_take(const Subdomain&) {}

    std::vector<Role> roles_; ///< by body; empty if all bodies are active
};

} // namespace tandem
