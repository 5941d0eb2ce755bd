// SPDX-License-Identifier: MIT
#include "scenes/simulate/surface_normals.h"

#include "scenes/motion.h"
#include "base/parallel.h"
#include "scenes/simulate/algebra.h"
#include "scenes/simulate/cone.h"
#include "scenes/simulate/stabilize.h"

#include <algorithm>
#include <unordered_map>

namespace tandem::simulate {

namespace {

constexpr double nearness = 1e-3;        ///< distance of nearby faces, times the smaller body's size
constexpr double normal_rounding = 1e-6; ///< rounding error of a normal in single precision
constexpr double tilt = 0.1;             ///< radians, largest tilt of faces that rest on each other
constexpr double least_cosine = 0.1;     ///< a face more parallel to a direction gives no depth along it

/// A tetrahedron of a contact. `sign` is 1 if its body is a, -1 if it is b.
struct ContactSide {
    std::uint32_t body, tetrahedron;
    double sign;
};

/// Boundary faces of one body near a contact, in world axes; `rays` are their normals, directed out of body
/// a.
struct NearBoundary {
    std::vector<NearFace> faces;
    std::vector<Eigen::Vector3d> rays;

    void find(const Model& model, const Frame& frame, const ContactSide& side, const Eigen::Vector3d& point,
              double slack) {
        const auto& pose = frame.poses[side.body];
        const auto mesh = model.scene->bodies[side.body].mesh;
        model.boundaries[mesh].near(model.scene->meshes[mesh], side.tetrahedron,
                                    rotated(pose.rotation.conjugate(), point - pose.translation), slack,
                                    faces);
        rays.clear();
        for (auto& face : faces) {
            face.normal = rotated(pose.rotation, face.normal);
            rays.push_back(side.sign * face.normal);
        }
    }

    /// Distance (m) from the contact's point out of the body along `direction`; 0 when no face lies across
    /// it.
    double exit_distance(const Eigen::Vector3d& direction) const {
        double least = 0;
        bool found = false;
        for (std::size_t i = 0; i < faces.size(); ++i) {
            const double across = dot(rays[i], direction);
            if (across < least_cosine) continue;
            const double distance = faces[i].height / across;
            least = found ? std::min(least, distance) : distance;
            found = true;
        }
        return least;
    }
};

std::uint64_t bodies_of(const Pair& pair) { return std::uint64_t{pair.body_a} << 32 | pair.body_b; }

/// Greatest penetration (m) of each body pair, by bodies_of().
using Depths = std::unordered_map<std::uint64_t, double>;

Depths deepest_of(std::span<const ContactPoint> contacts) {
    Depths depths;
    for (const auto& contact : contacts) {
        auto& depth = depths[bodies_of(contact.pair)];
        depth = std::max(depth, -contact.depth);
    }
    return depths;
}

/// Corrects normals; each thread has its own.
struct NormalCorrector {
    const Model& model;
    const Frame& frame;
    const Depths& depths;
    NearBoundary a, b;

    void correct(ContactPoint& contact) {
        const auto& pair = contact.pair;
        const Eigen::Vector3d point(contact.point[0], contact.point[1], contact.point[2]);
        const Eigen::Vector3d original(contact.normal[0], contact.normal[1], contact.normal[2]);
        // A point on the surface of one body lies below the other's surface by the penetration.
        const double slack = nearness * pair_size(model, pair) + depths.at(bodies_of(pair));
        a.find(model, frame, {pair.body_a, pair.tet_a, 1}, point, slack);
        b.find(model, frame, {pair.body_b, pair.tet_b, -1}, point, slack);
        const double deviation = outside(a.rays, b.rays, original);
        if (deviation <= normal_rounding) return;
        auto normal = moved_into_cones(a.rays, b.rays, original);
        const double remaining = outside(a.rays, b.rays, normal);
        // Penetrating bodies that are tilted or curved have no common direction. With a small deviation, the
        // face defines the normal for the corner or edge inside it, as for bodies that just touch. Otherwise
        // the point may be off the loaded edge, whose normal no face has.
        if (remaining > normal_rounding && deviation < tilt && (a.rays.size() == 1) != (b.rays.size() == 1))
            normal = a.rays.size() == 1 ? a.rays[0] : b.rays[0];
        else if (deviation <= 2 * remaining + normal_rounding)
            return;
        for (int i = 0; i < 3; ++i) contact.normal[static_cast<std::size_t>(i)] = normal[i];
        contact.depth = -(a.exit_distance(normal) + b.exit_distance(normal));
    }
};

} // namespace

void set_surface_normals(const Model& model, const Frame& frame, std::span<ContactPoint> contacts) {
    constexpr std::size_t part = 256; // contacts a task
    const auto deforms = [&](std::uint32_t body) { return model.bodies[body].kind == BodyKind::soft; };
    const auto depths = deepest_of(contacts);
    parallel_for((contacts.size() + part - 1) / part, [&](std::size_t i) {
        NormalCorrector corrector{model, frame, depths, {}, {}};
        for (auto& contact : contacts.subspan(i * part, std::min(part, contacts.size() - i * part)))
            if (!deforms(contact.pair.body_a) && !deforms(contact.pair.body_b)) corrector.correct(contact);
    });
}

} // namespace tandem::simulate
