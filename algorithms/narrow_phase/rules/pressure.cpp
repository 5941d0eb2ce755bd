// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_polygon.h"

namespace tandem::narrow_phase {

namespace {

template<class Real>
using Polygon = std::vector<Vector<Real>>;

/// A linear function on a tetrahedron: its value at the first corner, its gradient and the gradient's error.
template<class Real>
struct LinearField {
    Real at_first;
    Vector<Real> gradient{};
    Real error = 0;

    /// `values`: at the corners.
    LinearField(const ReferencePair<Real>& pair, unsigned solid, const std::array<Real, 4>& values)
        : at_first(values[0]) {
        const auto& world = pair.world[solid];
        Real sum = 0, longest = 0, least = std::numeric_limits<Real>::infinity();
        for (unsigned i = 1; i < 4; ++i) {
            const auto& normal = pair.solids[solid].normals[i];
            const auto edge = (world[i] - world[0]) * pair.scale;
            const Real height = dot(normal, edge);
            gradient = gradient + normal * ((values[i] - values[0]) / height);
            sum += (std::abs(values[i]) + std::abs(values[0])) / std::abs(height);
            longest = std::max(longest, largest(edge));
            least = std::min(least, std::abs(height));
        }
        error = 8 * unit_roundoff<Real> * (sum * (1 + longest / least));
    }

    /// `offset`: from the first corner.
    Real at(const Vector<Real>& offset) const { return at_first + dot(gradient, offset); }
};

/// 5 pi / 8 is the largest angle between a polygon's normal and a gradient.
template<class Real>
bool is_along(const Vector<Real>& gradient, const Vector<Real>& normal) {
    const Real cosine = Real(-0.3826834323650898);
    return dot(gradient, normal) >= cosine * std::sqrt(dot(gradient, gradient));
}

template<class Real>
Vector<Real> zero_between(const Vector<Real>& from, const Vector<Real>& to, Real at_from, Real at_to) {
    return from + (to - from) * (at_from / (at_from - at_to));
}

/// The pressures of solid `own` less those of the other field at its corners; 0 within rounding.
template<class Real>
std::array<Real, 4> excess(const ReferencePair<Real>& pair, unsigned own,
                           const std::array<Real, 4>& pressures, const LinearField<Real>& other) {
    std::array<Real, 4> result;
    for (unsigned i = 0; i < 4; ++i) {
        const auto offset = (pair.world[own][i] - pair.world[1 - own][0]) * pair.scale;
        const Real there = other.at(offset);
        const auto& g = other.gradient;
        const Real terms = taxicab<Real>({g[0] * offset[0], g[1] * offset[1], g[2] * offset[2]});
        const Real error =
            16 * unit_roundoff<Real> * ((std::abs(pressures[i]) + std::abs(other.at_first)) + terms);
        const Real difference = pressures[i] - there;
        result[i] = std::abs(difference) <= error ? 0 : difference;
    }
    return result;
}

template<class Real>
void turn_signs(std::array<Real, 4>& values) {
    for (Real& value : values) value = 0 - value;
}

template<class Real>
bool is_downward(const Vector<Real>& n) {
    const Real xy = n[0] + Real(0.7548776662466927) * n[1];
    return xy + Real(0.5698402909980532) * n[2] < 0;
}

template<class Real>
bool is_cut(const std::array<Real, 4>& values) {
    return std::ranges::min(values) <= 0 && std::ranges::max(values) > 0;
}

template<class Real>
bool is_in_plane(const std::array<Real, 4>& values, unsigned face) {
    return std::ranges::all_of(face_corners[face], [&](unsigned corner) { return values[corner] == 0; });
}

/// The polygon where a linear function is 0, which has these values at the corners.
template<class Real>
Polygon<Real> plane_cut(Corners<Real> corners, std::array<Real, 4> values) {
    constexpr unsigned network[][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}};
    for (const auto& [i, j] : network)
        if (values[j] < values[i]) {
            std::swap(values[i], values[j]);
            std::swap(corners[i], corners[j]);
        }
    const auto below = std::ranges::count_if(values, [](Real value) { return value <= 0; });
    static const std::vector<std::array<unsigned, 2>> edges[] = {
        {{0, 1}, {0, 2}, {0, 3}}, {{0, 2}, {0, 3}, {1, 3}, {1, 2}}, {{0, 3}, {1, 3}, {2, 3}}};
    Polygon<Real> polygon;
    for (const auto& [i, j] : edges[below - 1])
        polygon.push_back(zero_between(corners[i], corners[j], values[i], values[j]));
    return polygon;
}

/// Without what is in front of a face.
template<class Real>
Polygon<Real> clipped(Polygon<Real> polygon, const Tetrahedron<Real>& solid, unsigned face) {
    std::vector<Real> heights;
    for (const auto& corner : polygon) heights.push_back(solid.distance(face, corner));
    const auto in_front = [](Real height) { return height > 0; };
    if (std::ranges::none_of(heights, in_front)) return polygon;
    const auto deepest = std::ranges::min_element(heights) - heights.begin();
    std::ranges::rotate(heights, heights.begin() + deepest);
    std::ranges::rotate(polygon, polygon.begin() + deepest);
    if (heights[0] > 0) return {};
    const auto first = static_cast<std::size_t>(std::ranges::find_if(heights, in_front) - heights.begin());
    auto last = heights.size() - 1;
    while (!in_front(heights[last])) --last;
    const auto after = (last + 1) % heights.size();
    const auto leaving = zero_between(polygon[first - 1], polygon[first], heights[first - 1], heights[first]);
    const auto entering = zero_between(polygon[after], polygon[last], heights[after], heights[last]);
    Polygon<Real> rest(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(first));
    rest.insert(rest.end(), {leaving, entering});
    rest.insert(rest.end(), polygon.begin() + static_cast<std::ptrdiff_t>(last) + 1, polygon.end());
    return rest;
}

/// Sets area and centroid of a polygon with corners and normal.
template<class Real>
void measure(PressurePolygon<Real>& polygon) {
    const auto& corners = polygon.corners;
    Real twice = 0;
    Vector<Real> moment{};
    for (std::size_t i = 2; i < corners.size(); ++i) {
        const auto e = corners[i - 1] - corners[0], f = corners[i] - corners[0];
        const Real part = std::abs(dot(cross(e, f), polygon.normal));
        twice += part;
        moment = moment + (e + f) * part;
    }
    polygon.area = Real(0.5) * twice;
    polygon.centroid = corners[0] + moment / (3 * twice);
}

/// Leaves of equal corners beside each other one.
template<class Real>
void merge_equal(Polygon<Real>& corners) {
    const auto rest = std::ranges::unique(corners);
    corners.erase(rest.begin(), rest.end());
    while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
}

} // namespace

template<class Real>
PressurePolygon<Real> pressure_polygon(const ReferencePair<Real>& pair) {
    Real largest = 0;
    for (const auto& four : pair.pressures)
        for (const Real value : four) largest = std::max(largest, std::abs(value));
    const Real scale = scale_of(largest);
    auto pressures = pair.pressures;
    for (auto& four : pressures)
        for (Real& value : four) value *= scale;
    const Real low = std::max(std::ranges::min(pressures[0]), std::ranges::min(pressures[1]));
    const Real high = std::min(std::ranges::max(pressures[0]), std::ranges::max(pressures[1]));
    const LinearField a(pair, 0, pressures[0]), b(pair, 1, pressures[1]);
    const auto difference = a.gradient - b.gradient;
    if (tandem::narrow_phase::largest(difference) <= a.error + b.error) return {};
    PressurePolygon<Real> result;
    result.normal = unit(difference);
    if (!is_along(a.gradient, result.normal) || !is_along(b.gradient, result.normal * Real(-1))) return {};
    auto at_a = excess(pair, 0, pressures[0], b), at_b = excess(pair, 1, pressures[1], a);
    turn_signs(is_downward(result.normal) ? at_a : at_b); // the second is b's pressure less a's
    if (!is_cut(at_a) || !is_cut(at_b)) return {};
    result.corners = plane_cut(pair.solids[0].corners, at_a);
    for (unsigned face = 0; face < 4 && !result.corners.empty(); ++face)
        if (!is_in_plane(at_b, face))
            result.corners = clipped(std::move(result.corners), pair.solids[1], face);
    if (result.corners.empty()) return {};
    measure(result);
    merge_equal(result.corners);
    if (!(result.area > 0) || result.corners.size() < 3) return {};
    const auto& first = pair.solids[0].corners[0];
    result.pressure = std::clamp(a.at(result.centroid - first), low, high) / scale;
    for (const auto& corner : result.corners)
        result.pressures.push_back(std::clamp(a.at(corner - first), low, high) / scale);
    return result;
}

template PressurePolygon<float> pressure_polygon(const ReferencePair<float>&);
template PressurePolygon<double> pressure_polygon(const ReferencePair<double>&);

template<class Real>
std::vector<Contact<Real>> pressure_contacts(const ReferencePair<Real>& pair, const Boundaries&) {
    const auto polygon = pressure_polygon(pair);
    if (polygon.corners.empty()) return {};
    auto contact = pair.contact({static_cast<unsigned>(polygon.corners.size()), polygon.centroid},
                                polygon.normal, polygon.area / pair.scale);
    contact.pressure = polygon.pressure + Real(0);
    return {contact};
}

TANDEM_REFERENCE_OF(pressure)

} // namespace tandem::narrow_phase
