// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/digest.h"
#include "algorithms/bodies/frame_input.h"
#include "algorithms/bounds/geometry.h"
#include "algorithms/narrow_phase/contact_settings.h"
#include "scenes/scene.h"

namespace tandem {

/// The answer of independent host code with the cell's own arithmetic: a correct cell has exactly this
/// answer.
struct ReferenceAnswer {
    std::vector<Pair> pairs; ///< sorted
    Digest digest;
    std::uint64_t contacts = 0;
    std::uint64_t degenerate = 0;
    std::uint64_t without_boundary = 0;
    std::uint64_t rejected = 0;
    std::uint64_t undecided_by_filter = 0, undecided_by_double = 0;
    Digest contact_digest;
    /// With settings.within_sphere_boxes: body pairs that are left out although their root k-DOPs overlap,
    /// and the candidate pairs of these.
    std::uint64_t dropped_body_pairs = 0, dropped_pairs = 0;
};

enum class Method {
    brute_force, ///< tests all pairs of tetrahedra of two bodies; for small scenes
    sweep        ///< sorts the tetrahedra of overlapping bodies along the first direction
};

/// Finds every pair of tetrahedra of different bodies that may meet and whose leaf k-DOPs overlap, and
/// filters them if settings.walked is not all. With settings.self also those of one body that share no
/// vertex. With a successor in `input` (motion=linear) k-DOPs contain both frames and the path between.
/// settings.within_sphere_boxes keeps the body pairs that BroadSweep finds with Broad::sphere_boxes. Runs on
/// all cores, and shares no other code with kernels, hierarchies or broad phase.
ReferenceAnswer reference(const Scene& scene, const FrameInput& input, const Geometry& geometry,
                          bool contacts, Method method, const ContactSettings& settings = {});

/// The pairs whose tetrahedra are walked by Walked::boundary, in the same order: both have boundary faces, or
/// are of a mesh without any.
std::vector<Pair> of_boundary(const Scene& scene, std::vector<Pair> pairs);

/// The pairs that walks of these tetrahedra can find, in the same order.
std::vector<Pair> pairs_walked(const Scene& scene, std::vector<Pair> pairs, Walked walked);

/// Brute force for small scenes, sweep otherwise.
Method reference_method(const Scene& scene);

/// Number of pairs only in `expected` (missing) and only in `found` (extra). Both must be sorted; duplicates
/// in `found` count as extra.
struct Difference {
    std::uint64_t missing = 0;
    std::uint64_t extra = 0;
};
Difference difference(std::span<const Pair> expected, std::span<const Pair> found);

} // namespace tandem
