// SPDX-License-Identifier: MIT
#pragma once

#include "harness/frames/flaws.h"

#include <memory>
#include <span>

namespace tandem {

/// Numbers of a body's flawed tetrahedra in one frame, ascending; the two lists are disjoint.
struct FlawedTetrahedra {
    std::vector<std::uint32_t> degenerate, non_finite;

    bool any() const { return !degenerate.empty() || !non_finite.empty(); }
    /// Both kinds, ascending.
    std::vector<std::uint32_t> all() const;
};

/// Finds the flawed tetrahedra of consecutive frames; it does not store the frames. The exact test of zero
/// volume (geometry/volume.h) uses the coordinates of the frame for a deformable body. For a rigid body it
/// uses those of the mesh, because poses preserve volume.
class FlawSearch {
public:
    /// `first` is the number of the first frame to add. The scene must outlive this object.
    FlawSearch(const Scene& scene, std::size_t first);

    /// Searches the next frames in parallel on all cores and counts their flaws.
    void add(std::span<const std::shared_ptr<Frame>> frames);
    /// The flaws of all added frames. Throws InputError when `handling` rejects them.
    Flaws flaws(Degenerate handling) const;

    /// Lists the flawed tetrahedra of a frame as `skipped`, and replaces coordinates that are not finite by
    /// finite ones of the same body. Only arithmetic over whole bodies reads these. Searches on all cores.
    void leave_out(Frame& frame) const;

private:
    using Found = std::vector<FlawedTetrahedra>; ///< by frame, then body; or by mesh
    const Mesh& mesh_of(std::size_t body) const;
    Found deformed(std::span<const Frame* const> frames) const;
    FlawedTetrahedra flaws_of(const Frame& frame, std::size_t body, const FlawedTetrahedra& deformed) const;

    const Scene& scene_;
    std::size_t next_; ///< number of the next frame
    Found rigid_;      ///< by mesh
    Flaws all_;        ///< with one entry for each body
    Flaws non_finite_; ///< the same without tetrahedra of zero volume
};

} // namespace tandem
