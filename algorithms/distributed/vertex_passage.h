// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/parameters/parameter.h"
#include "algorithms/distributed/halo.h"

namespace tandem {

/// The way of deformable bodies' vertices from the memory of one rank's device to that of another, as rows
/// that kernels read: no rank packs what another has packed, and none of it lies in a host's memory where the
/// message-passing library reaches devices. Functions that are marked so are called by all ranks together.
class VertexPassage {
public:
    /// By all ranks: it is taken where every device is reached and all have the same rows.
    VertexPassage(Ranks& ranks, const DeviceInfo& info, const Scene& scene, const Settings& settings);

    bool is_taken() const { return is_taken_; }
    /// By all ranks: vertices go the other way from now on.
    void give_up() { is_taken_ = false; }
    /// By all ranks: passes the rows of what the halo sends and gets. `bodies` and `part`: those of this
    /// rank's device, whose own rows have been waited for; null where it failed, and what comes is lost.
    void pass(const Halo& halo, const Bodies* bodies, const Scene* part, Halo::Traffic& traffic);
    /// Rows that came back to the host, as vertices of the part's frame.
    void bring(const Halo& halo, const Bodies& bodies, const Scene& part, Frame& frame) const;

private:
    std::vector<Ranks::Piece> pieces(const std::vector<std::vector<std::uint32_t>>& lists,
                                     const Bodies* bodies, const Scene* part);

    Ranks& ranks_;
    const Scene& scene_;
    std::vector<std::size_t> bytes_; ///< by mesh: of the rows of a deformable body
    Ranks::Bytes scratch_;           ///< instead of rows, where this rank has failed
    bool is_taken_ = false;
};

} // namespace tandem
