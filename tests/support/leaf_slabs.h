// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/orders/heap.h"
#include "tests/support/prepared_trees.h"
#include "tests/support/oracle_touch.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace tandem::support {

/// A scene of two bodies with one tetrahedron per pair: the first body has every a, the second every b.
/// Without poses the bodies are deformable and the corners are world vertices. With poses the corners are
/// those of the meshes.
class PairScene {
public:
    explicit PairScene(const std::vector<OraclePair>& pairs) : PairScene(pairs, nullptr) {}
    PairScene(const std::vector<OraclePair>& pairs, const std::array<Pose, 2>& poses)
        : PairScene(pairs, &poses) {}

    const Scene& scene() const { return scene_; }
    const Frame& frame() const { return frame_; }

private:
    PairScene(const std::vector<OraclePair>& pairs, const std::array<Pose, 2>* poses) {
        for (std::uint32_t body = 0; body < 2; ++body) {
            Mesh mesh;
            for (std::uint32_t i = 0; i < pairs.size(); ++i) {
                for (const auto& corner : body == 0 ? pairs[i].a : pairs[i].b)
                    mesh.vertices.emplace_back(corner[0], corner[1], corner[2]);
                mesh.tetrahedra.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
            }
            mesh.boundary.assign(pairs.size(), 0);
            scene_.meshes.push_back(std::move(mesh));
            scene_.bodies.push_back({.mesh = body, .fixed = false, .deformable = poses == nullptr});
            frame_.poses.push_back(poses == nullptr ? Pose{} : (*poses)[body]);
            frame_.deformed.emplace_back();
            if (poses == nullptr) frame_.deformed.back() = scene_.meshes.back().vertices;
        }
    }

    Scene scene_;
    Frame frame_;
};

/// The leaf slabs that a device computes for a PairScene.
template<class Real>
class LeafSlabs {
public:
    LeafSlabs(Device& device, const PairScene& pairs, const Geometry& geometry)
        : axes_(static_cast<std::size_t>(geometry.k) / 2),
          published_(geometry.rounding == Rounding::published) {
        constexpr std::uint32_t leaves = 32;
        PreparedTrees on_device(device, pairs.scene(), geometry, leaves, 1);
        on_device.update(pairs.frame());
        const auto nodes = on_device.nodes<Real>();
        for (std::uint32_t body = 0; body < 2; ++body) {
            const auto& ids = on_device.bodies.mesh(body).ids;
            const auto count = static_cast<std::uint32_t>(ids.size());
            slabs_[body].resize(count * 2 * axes_);
            const auto first = on_device.trees.first_slot(body) + on_device.trees.levels(body).front().slot;
            for (std::uint32_t item = 0; item < count; ++item) {
                const auto chunk = item / leaves * leaves;
                const auto slot = first + 2 * chunk + leaf_of(item - chunk, std::min(leaves, count - chunk));
                std::memcpy(&slabs_[body][ids[item] * 2 * axes_], &nodes[std::size_t{slot} * 2 * axes_],
                            2 * axes_ * sizeof(Real));
            }
        }
    }

    Real lower(unsigned body, std::size_t pair, std::size_t axis) const {
        return slabs_[body][pair * 2 * axes_ + axis];
    }
    Real upper(unsigned body, std::size_t pair, std::size_t axis) const {
        return slabs_[body][pair * 2 * axes_ + axes_ + axis];
    }
    /// Whether some axis separates tetrahedron a of the first body from b of the second, by the kernels'
    /// rule.
    bool separated(std::size_t pair) const { return separated(pair, pair); }
    bool separated(std::size_t a, std::size_t b) const {
        for (std::size_t axis = 0; axis < axes_; ++axis)
            if (beyond(lower(0, a, axis), upper(1, b, axis)) || beyond(lower(1, b, axis), upper(0, a, axis)))
                return true;
        return false;
    }

private:
    /// Heap index of an item of a chunk: the deepest leaves contain the first items.
    static std::uint32_t leaf_of(std::uint32_t item, std::uint32_t items) {
        const auto width = 1u << ceil_log2(items);
        return item + width < 2 * items ? item + width : item + width - items;
    }
    bool beyond(Real lower, Real upper) const {
        return published_ ? lower - upper > static_cast<Real>(0x1.4p-20) : lower > upper;
    }

    std::size_t axes_;
    bool published_;
    std::array<std::vector<Real>, 2> slabs_;
};

/// Pairs whose contact plane is perpendicular to an integer direction (families 1 and 2 of the hard cases): a
/// corner of one touches the middle of a face of the other. All coordinates are on the coarsest lattice that
/// is exact in Real near `offset`, so most of them use every digit.
template<class Real>
class SlabTouchMaker {
public:
    using Direction = std::array<int, 3>;

    SlabTouchMaker(std::uint64_t seed, double offset)
        : random_(seed),
          offset_(offset),
          unit_(std::ldexp(1.0, std::ilogb(offset + 2) + 1 - std::numeric_limits<Real>::digits)) {}

    /// The contact is near `offset` times `position`. `shift`: lattice units by which b moves into a (out of
    /// it when negative) along one of d's axes.
    OraclePair touching(const Direction& d, const std::array<double, 3>& position, int shift = 0) {
        for (;;) {
            const auto contact = point(0.25, position);
            const auto u = in_plane(d);
            const auto v = in_plane(d);
            OraclePair pair{{contact, contact, contact, contact}, {contact, contact, contact, contact}};
            for (unsigned i = 0; i < 3; ++i) {
                pair.a[0][i] += u[i];
                pair.a[1][i] += v[i];
                pair.a[2][i] -= u[i] + v[i];
            }
            add_beside(pair.a[3], d, -1);
            for (unsigned i = 1; i < 4; ++i) add_beside(pair.b[i], d, 1);
            if (TouchMaker::determinant(relative(pair.a, contact)) == 0
                || TouchMaker::determinant(relative(pair.b, contact)) == 0)
                continue;
            move(pair.b, d, shift);
            if ((random_.next() & 1) != 0) std::swap(pair.a, pair.b);
            return pair;
        }
    }

    double unit() const { return unit_; }

private:
    double lattice(double low, double high) { return unit_ * std::floor(random_.uniform(low, high) / unit_); }

    std::array<double, 3> point(double spread, const std::array<double, 3>& position) {
        std::array<double, 3> p;
        for (unsigned i = 0; i < 3; ++i)
            p[i] = unit_ * std::nearbyint(offset_ * position[i] / unit_) + lattice(-spread, spread);
        return p;
    }

    /// A vector with d . v = 0: the last axis of d compensates for the other two.
    std::array<double, 3> in_plane(const Direction& d) {
        std::array<double, 3> v{};
        double sum = 0;
        unsigned last = 0;
        for (unsigned i = 0; i < 3; ++i) {
            v[i] = lattice(-0.3, 0.3);
            if (d[i] != 0) last = i;
        }
        for (unsigned i = 0; i < 3; ++i)
            if (i != last) sum += d[i] * v[i];
        v[last] = -d[last] * sum;
        return v;
    }

    /// Moves a corner off the plane, to the side that `side` gives relative to d.
    void add_beside(std::array<double, 3>& corner, const Direction& d, int side) {
        std::array<double, 3> v{};
        double along = 0;
        while (along == 0) {
            along = 0;
            for (unsigned i = 0; i < 3; ++i) {
                v[i] = lattice(-0.5, 0.5);
                along += d[i] * v[i];
            }
        }
        const double sign = (along > 0) == (side > 0) ? 1 : -1;
        for (unsigned i = 0; i < 3; ++i) corner[i] += sign * v[i];
    }

    void move(TetraCorners& corners, const Direction& d, int shift) const {
        unsigned axis = 0;
        while (d[axis] == 0) ++axis;
        for (auto& corner : corners) corner[axis] -= d[axis] * shift * unit_;
    }

    /// Coordinates relative to the contact in lattice units. They have few digits, so the determinant's sign
    /// is exact in double for float lattices.
    TetraCorners relative(TetraCorners corners, const std::array<double, 3>& contact) const {
        for (auto& corner : corners)
            for (unsigned i = 0; i < 3; ++i) corner[i] = (corner[i] - contact[i]) / unit_;
        return corners;
    }

    Random random_;
    double offset_, unit_;
};

} // namespace tandem::support
