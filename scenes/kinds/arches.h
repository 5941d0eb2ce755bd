// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/assembly.h"

namespace tandem {

/// A round arch of wedge stones on two pillars of boxes. Its own frame: the ground is y = 0, x along the
/// opening, z through it.
struct ArchShape {
    double outer = 1;           ///< radius to the outer edges of the stones
    double inner = 0.6;         ///< radius to their inner edges
    double depth = 0.8;         ///< along z
    std::uint64_t stones = 7;   ///< of the arch; odd, the middle one is the keystone
    std::uint64_t segments = 5; ///< of a pillar, which is as high as `outer`
};

/// The meshes of an arch in a scene, to be placed any number of times. All stones of an arch share one pose
/// and, where they meet, vertices of the same bits; heights are sums that are exact in single precision.
class Arch {
public:
    /// Adds the meshes. Throws InputError when the shape is impossible.
    Arch(Assembly& assembly, const ArchShape& shape);

    /// Stands an arch on y = `base`, turned by `turn` about the vertical and then moved by (x, z).
    void place(Assembly& assembly, double turn, double x, double base, double z, bool keystone = true) const;
    /// From the base to the level top of the keystone, a little below pillar height plus outer radius.
    double height() const { return height_; }

private:
    ArchShape shape_;
    double segment_height_, pillar_height_, height_;
    std::uint32_t pillar_;
    std::vector<std::uint32_t> stones_;
};

/// Layers of arches side by side in a circle, with a ring of stones on each layer whose joints lie over the
/// keystones: 18 bodies to an arch.
struct Amphitheatre {
    double inner = 10; ///< radius
    double width = 1;  ///< outer less inner radius
    std::uint64_t slices = 24, layers = 4;
    bool keystone = true; ///< false: the first arch of the lowest layer has none
};

void add_amphitheatre(Assembly& assembly, const Amphitheatre& shape);

} // namespace tandem
