// SPDX-License-Identifier: MIT
#include "algorithms/bodies/cost.h"

#include "algorithms/bounds/geometry.h"
#include "algorithms/kernels/counter.h"
#include "algorithms/parameters/table.h"
#include "algorithms/orders/order.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace tandem {

namespace {

double number(std::size_t value) { return static_cast<double>(value); }

/// A set of indices.
class Marks {
public:
    /// Returns whether the index is new.
    bool add(std::size_t index) {
        if (index >= marked_.size()) marked_.resize(index + 1);
        if (marked_[index]) return false;
        marked_[index] = true;
        ++count_;
        return true;
    }
    double count() const { return number(count_); }

private:
    std::vector<bool> marked_;
    std::size_t count_ = 0;
};

/// Number of vertices of the walked tetrahedra.
std::size_t vertices_of(const Mesh& mesh, Walked walked) {
    if (walked == Walked::all) return mesh.vertices.size();
    std::set<std::uint32_t> vertices;
    for (const auto id : walked_tetrahedra(mesh, walked))
        vertices.insert(mesh.tetrahedra[id].begin(), mesh.tetrahedra[id].end());
    return vertices.size();
}

double total(const std::vector<Marks>& all) {
    return std::accumulate(all.begin(), all.end(), 0.0,
                           [](double sum, const Marks& marks) { return sum + marks.count(); });
}

} // namespace

double FrameFacts::counted(std::string_view counter) const {
    const auto found = work.find(counter);
    return found == work.end() ? 0 : found->second;
}

/// In the published data path all bodies are refitted, and no data are shared.
SceneFacts::SceneFacts(const Scene& scene, const Settings& settings) {
    const auto geometry = geometry_of(settings);
    const bool published = is_published(settings);
    bodies = number(scene.bodies.size());
    k = ends_of_node(geometry);
    real = number(real_bytes(geometry));
    pose_bytes = number(pose_reals(geometry)) * real;
    row_bytes = 4 * number(words_of(settings[parameters::pair_layout]));
    pair_bytes = has_pairs(settings[parameters::output]) ? row_bytes : 0;
    const auto walked = walked_of(settings);
    std::vector<std::size_t> vertices; // by mesh, of walked tetrahedra
    for (const auto& mesh : scene.meshes) vertices.push_back(vertices_of(mesh, walked));
    std::set<std::uint32_t> meshes, shared; // meshes with counted tetrahedra, and with counted vertices
    for (const auto& body : scene.bodies) {
        if (body.fixed && !published) continue;
        const auto& mesh = scene.meshes[body.mesh];
        tetrahedra.push_back(static_cast<std::uint32_t>(count_walked(mesh, walked)));
        const bool first = meshes.insert(body.mesh).second;
        if (first) mesh_tetrahedra.push_back(tetrahedra.back());
        if (first || published) tetrahedron_rows += number(tetrahedra.back());
        if (body.deformable || published || shared.insert(body.mesh).second)
            vertex_rows += number(vertices[body.mesh]);
    }
    moving = number(tetrahedra.size());
}

void add_touched(FrameFacts& facts, const Scene& scene, const Settings& settings,
                 std::span<const Pair> pairs) {
    const bool published = is_published(settings);
    // `rows` and `vertices` have an entry for each body, followed by one for each mesh.
    std::vector<Marks> bodies(scene.bodies.size()), rows(bodies.size() + scene.meshes.size()), vertices(rows);
    const auto touch = [&](std::uint32_t body, std::uint32_t tetrahedron) {
        if (!bodies[body].add(tetrahedron)) return;
        const auto& instance = scene.bodies[body];
        const auto mesh_entry = scene.bodies.size() + instance.mesh;
        rows[published ? body : mesh_entry].add(tetrahedron);
        for (const auto vertex : scene.meshes[instance.mesh].tetrahedra[tetrahedron])
            vertices[published || instance.deformable ? body : mesh_entry].add(vertex);
    };
    for (const auto& pair : pairs) {
        touch(pair.body_a, pair.tet_a);
        touch(pair.body_b, pair.tet_b);
    }
    facts.touched += total(bodies);
    facts.touched_rows += total(rows);
    facts.touched_vertices += total(vertices);
}

KernelCost walk_cost(const SceneFacts& scene, std::string_view entry) {
    return {
        entry,
        [=](const FrameFacts& f) { return scene.dop() * f.touched + scene.pair_bytes * f.candidate_pairs; },
        [k = scene.k](const FrameFacts& f) { return k * f.counted(counters::bvtt_nodes.name); },
        "nodes of tetrahedra in candidate pairs in, candidate pairs out; k a node pair tested"};
}

} // namespace tandem
