// SPDX-License-Identifier: MIT
// Bodies in the layout that the paper's code uploads in every frame: the same arrays on one thread and on
// several.
#include "algorithms/bodies/pack.h"
#include "algorithms/published/host_trees.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

/// Enough bodies for several threads; every other one is deformable.
Scene mixed_scene() {
    auto scene = crowd(11, 40, 1.0);
    const auto at_rest = scene.frame;
    for (std::size_t body = 0; body < scene.bodies.size(); body += 2) scene.bodies[body].deformable = true;
    scene.frame = [at_rest, bodies = scene.bodies, meshes = scene.meshes](std::size_t step) {
        auto frame = at_rest(step);
        frame.deformed.resize(bodies.size());
        for (std::size_t body = 0; body < bodies.size(); body += 2) {
            frame.deformed[body] = meshes[bodies[body].mesh].vertices;
            for (auto& p : frame.deformed[body]) p *= 1.0 + 0.01 * static_cast<double>(body);
        }
        return frame;
    };
    return scene;
}

/// Expected arrays: those of each body, one after the other.
template<class Real>
void expect_bodies(const Bodies& bodies, const Frame& frame, const Converted& converted,
                   std::size_t node_bytes) {
    std::vector<std::byte> vertices;
    std::vector<std::uint32_t> tetrahedra, owners;
    std::vector<std::uint8_t> boundary;
    const auto& scene = bodies.scene();
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
        const auto& mesh = bodies.mesh(body);
        const auto& own = scene.bodies[body].deformable ? frame.deformed[body]
                                                        : scene.meshes[scene.bodies[body].mesh].vertices;
        pack_vertices(vertices, bodies.geometry(), mesh, own);
        tetrahedra.insert(tetrahedra.end(), mesh.tetrahedra.begin(), mesh.tetrahedra.end());
        boundary.insert(boundary.end(), mesh.boundary.begin(), mesh.boundary.end());
        owners.insert(owners.end(), mesh.vertices.size(), body);
    }
    EXPECT_TRUE(
        std::equal(vertices.begin(), vertices.end(), converted.vertices.begin(), converted.vertices.end()));
    EXPECT_TRUE(std::equal(tetrahedra.begin(), tetrahedra.end(), converted.tetrahedra.begin(),
                           converted.tetrahedra.end()));
    EXPECT_TRUE(std::equal(owners.begin(), owners.end(), converted.vertex_bodies.begin(),
                           converted.vertex_bodies.end()));
    EXPECT_TRUE(
        std::equal(boundary.begin(), boundary.end(), converted.boundary.begin(), converted.boundary.end()));
    EXPECT_EQ(converted.poses, bodies.packed_poses(frame));
    EXPECT_TRUE(converted.rigid);
    ASSERT_EQ(converted.nodes.size(), node_bytes);
    const auto k = static_cast<std::size_t>(bodies.geometry().k);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < node_bytes / sizeof(Real); ++i) {
        Real value;
        std::memcpy(&value, converted.nodes.data() + i * sizeof(Real), sizeof(Real));
        const auto limit = std::numeric_limits<Real>::max();
        wrong += value != (i % k < k / 2 ? limit : -limit);
    }
    EXPECT_EQ(wrong, 0u);
}

TEST(PublishedConversion, OneThreadAndSeveralMakeTheSameArrays) {
    auto& host = device("host");
    const auto scene = mixed_scene();
    const auto frame = scene.frame(0);
    for (const auto precision : {Precision::fp32, Precision::fp64}) {
        Geometry geometry;
        geometry.precision = precision;
        const Bodies bodies(host, scene, geometry, Bodies::Sharing::none);
        // Several blocks, the last one partly filled.
        const std::size_t node_bytes = std::size_t{5 * 1000 * 1000 / 288} * 288;
        for (const auto& [conversion, threads] :
             {std::pair{Conversion::serial, 0u}, {Conversion::parallel, 0u}, {Conversion::parallel, 3u}}) {
            Converter converter(bodies, conversion, threads);
            const auto converted = converter.convert(frame, node_bytes);
            if (precision == Precision::fp64)
                expect_bodies<double>(bodies, frame, converted, node_bytes);
            else
                expect_bodies<float>(bodies, frame, converted, node_bytes);
        }
    }
}

/// Nodes pass through the trees of the host unchanged, but for the slot before each chunk's root.
TEST(PublishedConversion, TreesOfTheHostKeepAllNodes) {
    auto& host = device("host");
    const auto scene = mixed_scene();
    const Bodies bodies(host, scene, Geometry{}, Bodies::Sharing::none);
    const ChunkTrees trees(bodies, 4, 1);
    std::size_t chunks = 0;
    for (std::uint32_t body = 0; body < bodies.count(); ++body)
        for (const auto& level : trees.levels(body)) chunks += level.chunks;
    const std::vector<BodyPair> pairs{{0, 1}, {1, 5}, {1, 1}};
    for (const auto conversion : {Conversion::serial, Conversion::parallel}) {
        Converter converter(bodies, conversion, 0);
        std::vector<std::byte> marked(trees.nodes().bytes()), flat(marked.size());
        for (std::size_t i = 0; i < marked.size(); ++i) marked[i] = static_cast<std::byte>(1 + i % 251);
        HostTrees own(trees);
        own.store(marked, converter);
        own.copy(pairs, converter);
        own.flatten(flat, converter);
        const auto node = marked.size() / trees.slots();
        std::size_t unused = 0;
        for (std::size_t slot = 0; slot < trees.slots(); ++slot) {
            const bool is_equal = std::memcmp(&marked[slot * node], &flat[slot * node], node) == 0;
            unused += is_equal ? 0 : 1;
            EXPECT_TRUE(is_equal || flat[slot * node] == std::byte{0});
        }
        EXPECT_EQ(unused, chunks);
    }
}

} // namespace
} // namespace tandem
