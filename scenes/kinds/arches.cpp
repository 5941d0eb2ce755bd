// SPDX-License-Identifier: MIT
#include "scenes/kinds/arches.h"

#include "base/error.h"
#include "scenes/motion.h"
#include "base/random.h"
#include "scenes/shapes.h"

#include <numbers>
#include <algorithm>

namespace tandem {

namespace {

using std::numbers::pi;

/// Stone `number` of the arch, counted from +x; the origin is the centre of the arch.
Mesh wedge(const ArchShape& shape, std::uint64_t number) {
    std::array<Eigen::Vector3d, 8> corners;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const double radius = (corner & 1) != 0 ? shape.outer : shape.inner;
        const auto joint = static_cast<double>(number + ((corner & 2) != 0 ? 1 : 0));
        const auto turn = sine_cosine(pi * joint / static_cast<double>(shape.stones));
        corners[corner] = {radius * turn.cosine, radius * turn.sine,
                           ((corner & 4) != 0 ? 0.5 : -0.5) * shape.depth};
    }
    return hexahedron(corners);
}

/// A stone of the ring above a layer; the origin is the centre of the ring's cross-section.
Mesh ring_stone(const Amphitheatre& shape, double height) {
    const auto turn = sine_cosine(pi / static_cast<double>(shape.slices));
    const double centre = shape.inner + 0.5 * shape.width;
    std::array<Eigen::Vector3d, 8> corners;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const double radius = (corner & 4) != 0 ? shape.inner + shape.width : shape.inner;
        corners[corner] = {((corner & 1) != 0 ? radius : -radius) * turn.sine,
                           ((corner & 2) != 0 ? 0.5 : -0.5) * height, radius * turn.cosine - centre};
    }
    return hexahedron(corners);
}

} // namespace

/// Heights are rounded to the grid before they are added, so that stones touch exactly. The upper vertices of
/// the keystone define the height of the arch.
Arch::Arch(Assembly& assembly, const ArchShape& shape) : shape_(shape) {
    if (shape.stones % 2 == 0)
        throw InputError("an arch with an even number of stones has no keystone; give an odd number");
    const double thickness = shape.outer - shape.inner;
    segment_height_ = halved_on_grid(shape.outer / static_cast<double>(shape.segments));
    pillar_height_ = segment_height_ * static_cast<double>(shape.segments);
    pillar_ = assembly.add_box({thickness, segment_height_, shape.depth});
    for (std::uint64_t i = 0; i < shape.stones; ++i) stones_.push_back(assembly.add_mesh(wedge(shape, i)));
    double top = 0;
    for (const auto& v : assembly.mesh(stones_[shape.stones / 2]).vertices) top = std::max(top, v.y());
    height_ = pillar_height_ + top;
}

void Arch::place(Assembly& assembly, double turn_angle, double x, double base, double z,
                 bool keystone) const {
    const auto rotation = turn({0, 1, 0}, turn_angle);
    // Pillars are centred under the ring of stones.
    for (const double side : {1.0, -1.0}) {
        const auto foot = rotated(rotation, {side * 0.5 * (shape_.outer + shape_.inner), 0, 0});
        for (std::uint64_t i = 0; i < shape_.segments; ++i) {
            const double y = base + segment_height_ * (static_cast<double>(i) + 0.5);
            assembly.add(pillar_, {.pose = {rotation, {x + foot.x(), y, z + foot.z()}}});
        }
    }
    for (std::uint64_t i = 0; i < shape_.stones; ++i)
        if (keystone || i != shape_.stones / 2)
            assembly.add(stones_[i], {.pose = {rotation, {x, base + pillar_height_, z}}});
}

void add_amphitheatre(Assembly& assembly, const Amphitheatre& shape) {
    const double step = 2 * pi / static_cast<double>(shape.slices);
    const double outer = shape.inner * sine_cosine(0.5 * step).sine;
    const Arch arch(assembly, {.outer = outer, .inner = 0.6 * outer, .depth = 0.8 * shape.width});
    const double ring_height = halved_on_grid(0.4 * outer);
    const auto ring = assembly.add_mesh(ring_stone(shape, ring_height));
    const double centre = shape.inner + 0.5 * shape.width;
    double base = 0;
    for (std::uint64_t layer = 0; layer < shape.layers; ++layer) {
        for (std::uint64_t i = 0; i < shape.slices; ++i) {
            const double angle = step * static_cast<double>(i);
            const auto direction = sine_cosine(angle);
            arch.place(assembly, angle, centre * direction.sine, base, centre * direction.cosine,
                       shape.keystone || layer > 0 || i > 0);
            const double between = angle + 0.5 * step;
            const auto middle = sine_cosine(between);
            assembly.add(ring, {.pose = {turn({0, 1, 0}, between),
                                         {centre * middle.sine, base + arch.height() + 0.5 * ring_height,
                                          centre * middle.cosine}}});
        }
        base += arch.height() + ring_height;
    }
}

} // namespace tandem
