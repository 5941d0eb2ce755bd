// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/distributed/subdomain.h"
#include "backends/device.h"
#include "scenes/scene.h"

namespace tandem {

/// A hierarchy over the tetrahedra of every body, refitted every frame. What a walk needs of it beyond this,
/// it has from the concrete type: an algorithm makes both together.
class Hierarchy {
public:
    virtual ~Hierarchy() = default;
    Hierarchy() = default;
    Hierarchy(const Hierarchy&) = delete;
    Hierarchy& operator=(const Hierarchy&) = delete;

    /// Enqueues what makes every bound of `frame` from the vertices and poses that are on the device.
    /// Tetrahedra that the frame skips are in no bound. Bodies that do not move are left as they are unless
    /// `all` are to be refitted. Throws DeviceError.
    void refit(const Frame& frame, bool all = false) { do_refit(frame, all); }
    /// From the next refit on, which is of all of them, bodies that have no part in `share` are left out:
    /// their bounds are of no frame. Throws DeviceError.
    void take(const Subdomain& share, std::size_t bodies) {
        roles_ = roles_of(share, bodies);
        do_take();
    }

    /// The k-DOP of every body, K reals each (volume.clh), as the last refit made them.
    const Buffer& volumes() const { return do_volumes(); }
    /// The nodes, K reals each: what a data path that keeps nothing on the device has to move.
    const Buffer& nodes() const { return do_nodes(); }
    /// Bytes of device memory in all buffers.
    std::size_t bytes() const { return do_bytes(); }

protected:
    bool takes(std::uint32_t body) const { return roles_.empty() || roles_[body] != Role::none; }

private:
    virtual void do_refit(const Frame& frame, bool all) = 0;
    virtual const Buffer& do_volumes() const = 0;
    virtual const Buffer& do_nodes() const = 0;
    virtual std::size_t do_bytes() const = 0;
    /// A hierarchy may go on making all bounds.
    virtual void do_take() {}

    std::vector<Role> roles_; ///< by body; none where all take part
};

} // namespace tandem
