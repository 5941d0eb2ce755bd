// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_pair.h"

namespace tandem::narrow_phase {

namespace {

/// Eight corners, A's first, in the order of operations of certainty.clh.
template<class Real>
class Couple {
public:
    Couple(const Corners<Real>& a, const Corners<Real>& b) {
        std::copy(a.begin(), a.end(), world_.begin());
        std::copy(b.begin(), b.end(), world_.begin() + 4);
        const Real most = std::ldexp(Real(1), std::numeric_limits<Real>::max_exponent - 5);
        for (unsigned i = 0; i < 8; ++i) {
            local_[i] = world_[i] - world_[0];
            for (const Real x : local_[i]) usable_ = usable_ && std::isfinite(x) && std::abs(x) <= most;
            size_ = std::max(size_, largest(local_[i]));
        }
        if (!usable_) return;
        scale_ = scale_of(size_);
        size_ *= scale_;
        for (auto& corner : local_) corner = corner * scale_;
    }

    unsigned verdict() {
        if (!usable_) return 0;
        for (unsigned face = 0; face < 8 && !apart_; ++face) try_face(face / 4, face % 4);
        if (!apart_ && (behind_all_[0] != 0 || behind_all_[1] != 0)) return 2;
        for (const auto& [i, j] : edge_ends)
            for (const auto& [k, l] : edge_ends)
                if (!apart_) project(edge(i, j), edge(4 + k, 4 + l));
        return apart_ ? 1 : overlapping_ ? 2 : 0;
    }

private:
    Vector<Real> edge(unsigned i, unsigned j) const { return (world_[j] - world_[i]) * scale_; }

    /// Projects the corners on the cross product of two edges and records what the gap proves. Returns the
    /// projections and their error bound.
    std::pair<std::array<Real, 8>, Real> project(const Vector<Real>& p, const Vector<Real>& q) {
        const auto axis = cross(p, q);
        Vector<Real> terms;
        for (unsigned i = 0; i < 3; ++i) {
            const unsigned j = (i + 1) % 3, k = (i + 2) % 3;
            terms[i] = std::abs(p[j] * q[k]) + std::abs(p[k] * q[j]);
        }
        std::array<Real, 8> along;
        for (unsigned i = 0; i < 8; ++i) along[i] = dot(axis, local_[i]);
        const auto [low_a, high_a] = std::minmax({along[0], along[1], along[2], along[3]});
        const auto [low_b, high_b] = std::minmax({along[4], along[5], along[6], along[7]});
        const Real gap = std::max(low_b - high_a, low_a - high_b);
        const Real underflow = std::ldexp(Real(1), sizeof(Real) == 8 ? -1000 : -120);
        const Real u = unit_roundoff<Real>;
        const Real error = 20 * u * (terms[0] + terms[1] + terms[2]) * size_ + underflow;
        apart_ = apart_ || gap > 12 * u * taxicab(axis) * size_ + underflow;
        overlapping_ = overlapping_ && gap < -error;
        return {along, error};
    }

    void try_face(unsigned owner, unsigned face) {
        const auto& [first, second, third] = face_corners[face];
        const unsigned own = 4 * owner, other = 4 - own;
        const auto [along, error] = project(edge(own + first, own + second), edge(own + first, own + third));
        const Real height = along[own + face] - along[own + first];
        for (unsigned i = 0; i < 4; ++i) {
            const Real depth = along[other + i] - along[own + first];
            const bool same = height > 0 ? depth > error : -depth > error;
            if (std::abs(height) <= error || !same) behind_all_[owner] &= ~(1u << i);
        }
    }

    std::array<Vector<Real>, 8> world_, local_;
    std::array<unsigned, 2> behind_all_{15, 15}; ///< corners of the other tetrahedron, one bit each
    Real size_ = 0, scale_ = 1;
    bool usable_ = true, apart_ = false, overlapping_ = true;
};

} // namespace

template<class Real>
unsigned certain_verdict(const Corners<Real>& a, const Corners<Real>& b) {
    const auto finite = [](const Vector<Real>& p) {
        return std::all_of(p.begin(), p.end(), [](Real x) { return std::isfinite(x); });
    };
    if (!std::all_of(a.begin(), a.end(), finite) || !std::all_of(b.begin(), b.end(), finite)) return 0;
    auto first = a, second = b;
    std::sort(first.begin(), first.end());
    std::sort(second.begin(), second.end());
    if (second < first) std::swap(first, second);
    return Couple<Real>(first, second).verdict();
}

template unsigned certain_verdict(const Corners<float>&, const Corners<float>&);
template unsigned certain_verdict(const Corners<double>&, const Corners<double>&);

} // namespace tandem::narrow_phase
