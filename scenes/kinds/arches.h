// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/assembly.h"

namespace tandem {

/// A round arch of wedge stones on two pillars of boxes; lengths in m. In its coordinates the ground is y =
/// 0, x is along the opening and z is through it.
struct ArchShape {
    double outer = 1;           ///< radius to the outer edges of the stones
    double inner = 0.6;         ///< radius to their inner edges
    double depth = 0.8;         ///< size along z
    std::uint64_t stones = 7;   ///< stones of the arch, an odd number; the middle stone is the keystone
    std::uint64_t segments = 5; ///< boxes of a pillar, which is as high as `outer`
};

/// The meshes of an arch in a scene, which can be placed many times. All stones of an arch share one pose.
/// Adjacent stones have vertices of the same bits; heights are sums that are exact in single precision.
class Arch {
public:
    /// Adds the meshes. Throws InputError when the shape is impossible.
    Arch(Assembly& assembly, const ArchShape& shape);

    /// Adds an arch on y = `base`, rotated by `turn` radians about the vertical and then moved by (x, z).
    void place(Assembly& assembly, double turn, double x, double base, double z, bool keystone = true) const;
    /// From the base to the plane top of the keystone, slightly less than pillar height plus outer radius.
    double height() const { return height_; }

private:
    ArchShape shape_;
    double segment_height_, pillar_height_, height_;
    std::uint32_t pillar_;
    std::vector<std::uint32_t> stones_;
};

/// Layers of arches side by side in a circle. Each layer has a ring of stones on top whose joints lie above
/// the keystones: 18 bodies an arch.
struct Amphitheatre {
    double inner = 10; ///< inner radius, m
    double width = 1;  ///< outer minus inner radius, m
    std::uint64_t slices = 24, layers = 4;
    bool keystone = true; ///< false: the first arch of the lowest layer has no keystone
};

void add_amphitheatre(Assembly& assembly, const Amphitheatre& shape);

} // namespace tandem
