// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/parameters/parameter.h"
#include "algorithms/distributed/ghost_exchange.h"

namespace tandem {

/// The way of deformable bodies' vertices from the memory of one rank's device to that of another, as rows
/// that kernels read: no rank packs what another has packed, and none of it lies in a host's memory where the
/// message-passing library reaches devices. Functions that are marked so are called by all ranks together.
class DeviceVertexExchange {
public:
    /// By all ranks: it is taken where every device is reached and all have the same rows.
    DeviceVertexExchange(Ranks& ranks, const DeviceInfo& info, const Scene& scene, const Settings& settings);

    bool is_enabled() const { return is_enabled_; }
    /// By all ranks: vertices go the other way from now on.
    void disable() { is_enabled_ = false; }
    /// By all ranks: passes the rows of what the halo sends and gets. `bodies` and `part`: those of this
    /// rank's device, whose own rows have been waited for; null where it failed, and what comes is lost.
    void exchange(const GhostExchange& ghosts, const Bodies* bodies, const Scene* part,
                  GhostExchange::Traffic& traffic);
    /// Rows that came back to the host, as vertices of the part's frame.
    void download_received(const GhostExchange& ghosts, const Bodies& bodies, const Scene& part,
                           Frame& frame) const;

private:
    std::vector<Ranks::Piece> pieces(const std::vector<std::vector<std::uint32_t>>& lists,
                                     const Bodies* bodies, const Scene* part);

    Ranks& ranks_;
    const Scene& scene_;
    std::vector<std::size_t> bytes_; ///< by mesh: of the rows of a deformable body
    Ranks::Bytes scratch_;           ///< instead of rows, where this rank has failed
    bool is_enabled_ = false;
};

} // namespace tandem
