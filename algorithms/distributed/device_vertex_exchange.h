// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/parameters/parameter.h"
#include "algorithms/distributed/ghost_exchange.h"

namespace tandem {

/// Sends vertices of deformable ghost bodies from the device memory of one rank to that of another. They
/// travel as the rows that kernels read, so that receivers do not repack them; a GPU-aware message-passing
/// library needs no host copy. All ranks together call the functions marked "collective".
class DeviceVertexExchange {
public:
    /// Collective. Enabled when all devices are GPU-aware and all ranks have the same format of rows.
    DeviceVertexExchange(Ranks& ranks, const DeviceInfo& info, const Scene& scene, const Settings& settings);

    bool is_enabled() const { return is_enabled_; }
    /// Collective: from the next frame on, vertices travel through the host's memory.
    void disable() { is_enabled_ = false; }
    /// Collective: exchanges the rows of deformable ghost bodies. `bodies` and `local_scene` are those of
    /// this rank's device, and the upload of its own rows is complete. Null on a rank that failed, which
    /// discards the rows that it receives.
    void exchange(const GhostExchange& ghosts, const Bodies* bodies, const Scene* local_scene,
                  GhostExchange::Traffic& traffic);
    /// Downloads the received rows into the vertices of `frame`, a frame of `local_scene`.
    void download_received(const GhostExchange& ghosts, const Bodies& bodies, const Scene& local_scene,
                           Frame& frame) const;

private:
    std::vector<Ranks::Piece> pieces(const std::vector<std::vector<std::uint32_t>>& lists,
                                     const Bodies* bodies, const Scene* local_scene);

    Ranks& ranks_;
    const Scene& scene_;
    std::vector<std::size_t> bytes_; ///< by mesh: size of the rows of a deformable body
    Ranks::Bytes scratch_;           ///< replaces the rows on a rank that failed
    bool is_enabled_ = false;
};

} // namespace tandem
