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

constexpr double nearness = 1e-3;        ///< of faces to a contact, times the smaller body's size
constexpr double normal_rounding = 1e-6; ///< of a normal in single precision
constexpr double tilt = 0.1;             ///< radians, of faces that lie on each other
constexpr double in_parallel = 0.1; ///< cosine; a face nearer to parallel gives no depth along a direction

/// What bounds one body of a contact there, in world axes and pointing out of body a.
struct Surroundings {
    std::vector<NearFace> faces;
    std::vector<Eigen::Vector3d> rays;

    void find(const Model& model, const Frame& frame, std::uint32_t body, std::uint32_t tetrahedron,
              const Eigen::Vector3d& point, double slack, double sign) {
        const auto& pose = frame.poses[body];
        const auto mesh = model.scene->bodies[body].mesh;
        model.boundaries[mesh].near(model.scene->meshes[mesh], tetrahedron,
                                    rotated(pose.rotation.conjugate(), point - pose.translation), slack,
                                    faces);
        rays.clear();
        for (auto& face : faces) {
            face.normal = rotated(pose.rotation, face.normal);
            rays.push_back(sign * face.normal);
        }
    }

    /// m, from the contact's point out of the body along `direction`; 0 where no face lies across it.
    double way_out(const Eigen::Vector3d& direction) const {
        double least = 0;
        bool found = false;
        for (std::size_t i = 0; i < faces.size(); ++i) {
            const double across = dot(rays[i], direction);
            if (across < in_parallel) continue;
            const double way = faces[i].height / across;
            least = found ? std::min(least, way) : way;
            found = true;
        }
        return least;
    }
};

std::uint64_t bodies_of(const Pair& pair) { return std::uint64_t{pair.body_a} << 32 | pair.body_b; }

/// m, of every two bodies: the greatest of their contacts' depths.
using Depths = std::unordered_map<std::uint64_t, double>;

Depths deepest_of(std::span<const ContactPoint> contacts) {
    Depths depths;
    for (const auto& contact : contacts) {
        auto& depth = depths[bodies_of(contact.pair)];
        depth = std::max(depth, -contact.depth);
    }
    return depths;
}

/// Of one thread.
struct Mender {
    const Model& model;
    const Frame& frame;
    const Depths& depths;
    Surroundings a, b;

    void mend(ContactPoint& contact) {
        const auto& pair = contact.pair;
        const Eigen::Vector3d point(contact.point[0], contact.point[1], contact.point[2]);
        const Eigen::Vector3d given(contact.normal[0], contact.normal[1], contact.normal[2]);
        // A point on the surface of one is as far below the other's as the bodies are in each other.
        const double slack = nearness * pair_size(model, pair) + depths.at(bodies_of(pair));
        a.find(model, frame, pair.body_a, pair.tet_a, point, slack, 1);
        b.find(model, frame, pair.body_b, pair.tet_b, point, slack, -1);
        const double off = outside(a.rays, b.rays, given);
        if (off <= normal_rounding) return;
        auto normal = brought_into(a.rays, b.rays, given);
        const double left = outside(a.rays, b.rays, normal);
        // Nothing in common: bodies that are in each other and tilted, or curved. Where that is by little a
        // face decides for the corner or edge that is in it, as where they just touch; otherwise the point
        // may be off the edge that carries, whose normal no face has.
        if (left > normal_rounding && off < tilt && (a.rays.size() == 1) != (b.rays.size() == 1))
            normal = a.rays.size() == 1 ? a.rays[0] : b.rays[0];
        else if (off <= 2 * left + normal_rounding)
            return;
        for (int i = 0; i < 3; ++i) contact.normal[static_cast<std::size_t>(i)] = normal[i];
        contact.depth = -(a.way_out(normal) + b.way_out(normal));
    }
};

} // namespace

void set_surface_normals(const Model& model, const Frame& frame, std::span<ContactPoint> contacts) {
    constexpr std::size_t part = 256; // contacts a core takes at a time
    const auto deforms = [&](std::uint32_t body) { return model.bodies[body].kind == Kind::soft; };
    const auto depths = deepest_of(contacts);
    parallel_for((contacts.size() + part - 1) / part, [&](std::size_t i) {
        Mender mender{model, frame, depths, {}, {}};
        for (auto& contact : contacts.subspan(i * part, std::min(part, contacts.size() - i * part)))
            if (!deforms(contact.pair.body_a) && !deforms(contact.pair.body_b)) mender.mend(contact);
    });
}

} // namespace tandem::simulate
