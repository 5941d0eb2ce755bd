// SPDX-License-Identifier: MIT
#include "tests/unit/simulate/support.h"

#include "algorithms/narrow_phase/reference.h"
#include "scenes/motion.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace tandem::unit_test {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Tetrahedra between triangles and the last vertex.
Mesh fan(std::vector<Eigen::Vector3d> vertices, std::span<const Triangle> triangles) {
    Mesh mesh;
    mesh.name = "test";
    mesh.vertices = std::move(vertices);
    const auto apex = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    for (const auto& t : triangles) {
        const auto& p = mesh.vertices;
        const double side = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).dot(p[apex] - p[t[0]]);
        mesh.tetrahedra.push_back(side > 0 ? Tetrahedron{t[0], t[1], t[2], apex}
                                           : Tetrahedron{t[0], t[2], t[1], apex});
    }
    complete_mesh(mesh, "test");
    return mesh;
}

/// A body in the world.
struct Placed {
    std::uint32_t body;
    const Mesh* mesh;
    std::vector<Corners<double>> corners;
    std::vector<Eigen::AlignedBox3d> boxes;
    Eigen::AlignedBox3d box;
};

Placed place(const Scene& scene, const Frame& frame, std::uint32_t body) {
    const auto& mesh = scene.meshes[scene.bodies[body].mesh];
    const auto& pose = frame.poses[body];
    const auto* deformed = scene.bodies[body].deformable ? &frame.deformed[body] : nullptr;
    Placed result{body, &mesh, {}, {}, {}};
    for (const auto& t : mesh.tetrahedra) {
        auto& corners = result.corners.emplace_back();
        Eigen::AlignedBox3d box;
        for (std::size_t i = 0; i < 4; ++i) {
            const Eigen::Vector3d p =
                deformed ? (*deformed)[t[i]] : rotated(pose.rotation, mesh.vertices[t[i]]) + pose.translation;
            corners[i] = {p.x(), p.y(), p.z()};
            box.extend(p);
        }
        result.boxes.push_back(box);
        result.box.extend(box);
    }
    return result;
}

void add_contacts(const Placed& a, const Placed& b, const ContactSettings& settings,
                  std::vector<ContactPoint>& contacts) {
    ContactCounts counts;
    for (std::uint32_t i = 0; i < a.corners.size(); ++i)
        for (std::uint32_t j = 0; j < b.corners.size(); ++j) {
            if (!a.boxes[i].intersects(b.boxes[j])) continue;
            for (const auto& c :
                 reference_contacts<double>({a.corners[i], a.mesh->boundary[i]},
                                            {b.corners[j], b.mesh->boundary[j]}, counts, settings))
                contacts.push_back({{a.body, i, b.body, j}, c.feature, c.point, c.normal, c.depth, 0});
        }
}

} // namespace

Mesh hexahedron(const std::array<Eigen::Vector3d, 8>& corners) {
    constexpr std::array<std::array<std::uint32_t, 4>, 6> faces{
        {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
    std::vector<Triangle> triangles;
    for (const auto& f : faces) {
        triangles.push_back({f[0], f[1], f[2]});
        triangles.push_back({f[0], f[2], f[3]});
    }
    std::vector<Eigen::Vector3d> vertices(corners.begin(), corners.end());
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const auto& corner : corners) centre += corner / 8;
    vertices.push_back(centre);
    return fan(std::move(vertices), triangles);
}

Mesh box(const Eigen::Vector3d& size, const Eigen::Vector3d& centre) {
    std::array<Eigen::Vector3d, 8> corners;
    for (std::size_t i = 0; i < 8; ++i)
        corners[i] =
            centre
            + size.cwiseProduct(Eigen::Vector3d(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5));
    return hexahedron(corners);
}

Mesh beam(const Eigen::Vector3d& size, std::array<int, 3> cells) {
    Mesh mesh;
    mesh.name = "beam";
    const auto index = [&](int x, int y, int z) {
        return static_cast<std::uint32_t>((z * (cells[1] + 1) + y) * (cells[0] + 1) + x);
    };
    for (int z = 0; z <= cells[2]; ++z)
        for (int y = 0; y <= cells[1]; ++y)
            for (int x = 0; x <= cells[0]; ++x)
                mesh.vertices.emplace_back(size.x() * x / cells[0], size.y() * y / cells[1],
                                           size.z() * z / cells[2]);
    // Kuhn's split: one tetrahedron for each order of the three axes.
    std::array<int, 3> order{0, 1, 2};
    do {
        for (int z = 0; z < cells[2]; ++z)
            for (int y = 0; y < cells[1]; ++y)
                for (int x = 0; x < cells[0]; ++x) {
                    std::array<int, 3> cell{x, y, z};
                    Tetrahedron t{index(x, y, z), 0, 0, 0};
                    for (std::size_t i = 0; i < 3; ++i) {
                        ++cell[static_cast<std::size_t>(order[i])];
                        t[i + 1] = index(cell[0], cell[1], cell[2]);
                    }
                    const auto& p = mesh.vertices;
                    const Eigen::Vector3d normal = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
                    if (normal.dot(p[t[3]] - p[t[0]]) < 0) std::swap(t[2], t[3]);
                    mesh.tetrahedra.push_back(t);
                }
    } while (std::next_permutation(order.begin(), order.end()));
    complete_mesh(mesh, "test");
    return mesh;
}

Mesh ball(double radius, int times) {
    const double g = 1.6180339887498949;
    std::vector<Eigen::Vector3d> vertices{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                          {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                          {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    std::vector<Triangle> triangles{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int i = 0; i < times; ++i) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [it, fresh] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(vertices.size()));
            if (fresh) vertices.emplace_back((vertices[a] + vertices[b]) / 2);
            return it->second;
        };
        std::vector<Triangle> finer;
        for (const auto& [a, b, c] : triangles) {
            const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        triangles = std::move(finer);
    }
    for (auto& v : vertices) v *= radius / v.norm();
    vertices.emplace_back(Eigen::Vector3d::Zero());
    return fan(std::move(vertices), triangles);
}

World::World(Surface surface) { dynamics.materials = {{"stone"}, {2000}, {{{0, 0}, surface}}}; }

std::size_t World::add(Mesh mesh, const Pose& pose, bool fixed, const BodyDynamics& moves) {
    scene.meshes.push_back(std::move(mesh));
    scene.bodies.push_back({static_cast<std::uint32_t>(scene.meshes.size() - 1), fixed, false});
    start.poses.push_back(pose);
    start.deformed.emplace_back();
    dynamics.bodies.push_back(moves);
    return scene.bodies.size() - 1;
}

std::size_t World::add_soft(Mesh mesh, Elastic elastic, const BodyDynamics& moves) {
    const auto body = add(std::move(mesh), {}, false, moves);
    scene.bodies[body].deformable = true;
    start.deformed[body] = scene.meshes.back().vertices;
    dynamics.bodies[body].elastic = static_cast<std::int32_t>(dynamics.elastics.size());
    dynamics.elastics.push_back(std::move(elastic));
    return body;
}

const Scene& World::finish() {
    scene.name = "test";
    scene.frame = [frame = start](std::size_t) { return frame; };
    scene.dynamics = std::make_shared<Dynamics>(dynamics);
    return scene;
}

Pose at(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), {x, y, z}}; }

Detect detector(const Scene& scene, const ContactSettings& settings) {
    return [&scene, settings](const Frame& frame, std::vector<ContactPoint>& contacts) {
        std::vector<Placed> placed;
        for (std::uint32_t body = 0; body < scene.bodies.size(); ++body)
            placed.push_back(place(scene, frame, body));
        contacts.clear();
        for (std::uint32_t a = 0; a < placed.size(); ++a)
            for (std::uint32_t b = a + 1; b < placed.size(); ++b)
                if (placed[a].box.intersects(placed[b].box)
                    && !(scene.bodies[a].fixed && scene.bodies[b].fixed))
                    add_contacts(placed[a], placed[b], settings, contacts);
        std::sort(contacts.begin(), contacts.end(), [](const ContactPoint& a, const ContactPoint& b) {
            return std::tie(a.pair, a.feature) < std::tie(b.pair, b.feature);
        });
    };
}

void no_contacts(const Frame&, std::vector<ContactPoint>& contacts) { contacts.clear(); }

} // namespace tandem::unit_test
