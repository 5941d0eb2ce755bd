// SPDX-License-Identifier: MIT
#pragma once

#include "harness/verify/flaws.h"

#include <memory>
#include <span>

namespace tandem {

/// Ascending numbers of a body's flawed tetrahedra in one frame; none is in both lists.
struct FlawedTetrahedra {
    std::vector<std::uint32_t> degenerate, non_finite;

    bool any() const { return !degenerate.empty() || !non_finite.empty(); }
    /// Of both kinds, ascending.
    std::vector<std::uint32_t> all() const;
};

/// Finds the flawed tetrahedra of frames that are handed over one after the other and need not be kept.
/// Volumes are decided exactly (oracle/volume.h) for the coordinates that are given: those of the mesh for a
/// rigid body, whose poses change no volume, those of the frame for a deformable one.
class FlawSearch {
public:
    /// The frame that is added first has number `first`. The scene must outlive this.
    FlawSearch(const Scene& scene, std::size_t first);

    /// Counts what the next frames have, which are looked through together, on all cores.
    void add(std::span<const std::shared_ptr<Frame>> frames);
    /// Of all frames that were added. Throws InputError for what is refused.
    Flaws flaws(Degenerate handling) const;

    /// Lists what a frame has as `skipped` and puts something finite of the same body in the place of
    /// coordinates that are not, which nothing looks at but arithmetic that goes over whole bodies. Searches
    /// that frame, on all cores.
    void leave_out(Frame& frame) const;

private:
    using Found = std::vector<FlawedTetrahedra>; ///< by body, frame after frame; or by mesh
    const Mesh& mesh_of(std::size_t body) const;
    Found deformed(std::span<const Frame* const> frames) const;
    FlawedTetrahedra flaws_of(const Frame& frame, std::size_t body, const FlawedTetrahedra& deformed) const;

    const Scene& scene_;
    std::size_t next_; ///< number of the frame that is added next
    Found rigid_;      ///< by mesh
    Flaws all_;        ///< with one entry for each body, as the next
    Flaws non_finite_; ///< without those of zero volume
};

} // namespace tandem
