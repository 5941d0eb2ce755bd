// SPDX-License-Identifier: MIT
// The hierarchies on the device: containment, equal bits on host and OpenCL, and memory use.
#include "tests/support/prepared_trees.h"
#include "algorithms/bodies/pack.h"
#include "tests/support/cells.h"
#include "tests/support/long_form.h"
#include "tests/support/sanitized.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

std::vector<Geometry> geometries() {
    std::vector<Geometry> all;
    for (const int k : sanitized() ? std::vector{8, 18} : std::vector{6, 8, 12, 14, 16, 18, 20, 24, 26})
        for (const auto precision : {Precision::fp32, Precision::fp64}) {
            all.push_back({.k = k, .precision = precision});
            if (k != 8 && k != 26) continue; // these contain every kind of direction
            for (const auto rounding : {Rounding::nearest, Rounding::published})
                all.push_back({.k = k, .precision = precision, .rounding = rounding});
            all.push_back({.k = k, .precision = precision, .placement = Placement::exact});
        }
    return all;
}

std::vector<std::byte> bytes_in(const PreparedTrees& on_device, const Buffer& buffer, std::uint64_t rows) {
    std::vector<std::byte> bytes(rows * static_cast<std::uint64_t>(on_device.geometry().k)
                                 * real_bytes(on_device.geometry()));
    const StageScope scope(on_device.bodies.device(), Stage::read);
    on_device.bodies.device().download(buffer, bytes);
    return bytes;
}

/// A vertex in world coordinates, as the device computes it.
template<class Real>
std::array<Real, 3> world(const Scene& scene, const Frame& frame, std::uint32_t body, std::uint32_t vertex) {
    if (scene.bodies[body].deformable) {
        const auto& v = frame.deformed[body][vertex];
        return {static_cast<Real>(v.x()), static_cast<Real>(v.y()), static_cast<Real>(v.z())};
    }
    const auto& v = scene.meshes[scene.bodies[body].mesh].vertices[vertex];
    const auto rows = pose_rows(frame.poses[body]);
    std::array<Real, 3> result{};
    for (std::size_t i = 0; i < 3; ++i)
        result[i] = ((static_cast<Real>(rows[4 * i]) * static_cast<Real>(v.x())
                      + static_cast<Real>(rows[4 * i + 1]) * static_cast<Real>(v.y()))
                     + static_cast<Real>(rows[4 * i + 2]) * static_cast<Real>(v.z()))
                    + static_cast<Real>(rows[4 * i + 3]);
    return result;
}

/// Checks that the body's root slabs contain the exact projection of every vertex; returns the number of
/// checks.
template<class Real>
std::uint64_t check_roots(const Scene& scene, const Frame& frame, const PreparedTrees& on_device,
                          long double slack) {
    const auto& geometry = on_device.geometry();
    const auto volumes = on_device.volumes<Real>();
    const std::vector<double> values(volumes.begin(), volumes.end());
    const auto axes = directions(geometry);
    std::uint64_t checked = 0;
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
        const auto* root = &values[std::size_t{body} * static_cast<std::size_t>(geometry.k)];
        for (std::uint32_t v = 0; v < scene.meshes[scene.bodies[body].mesh].vertices.size(); ++v) {
            const auto p = world<Real>(scene, frame, body, v);
            for (std::size_t axis = 0; axis < axes.size(); ++axis) {
                long double exact =
                    0; // 64-bit significands represent these sums exactly for float, and to 2^-64 for double
                for (std::size_t i = 0; i < 3; ++i)
                    exact += static_cast<long double>(axes[axis][i]) * static_cast<long double>(p[i]);
                EXPECT_LE(static_cast<long double>(root[axis]), exact + slack * std::fabs(exact));
                EXPECT_GE(static_cast<long double>(root[axis + axes.size()]),
                          exact - slack * std::fabs(exact));
                ++checked;
            }
        }
    }
    return checked;
}

TEST(Bounds, SafeRootsContainEveryVertex) {
    const auto scene = crowd(61, 9, 50.0);
    const auto frame = scene.frame(1);
    std::uint64_t checked = 0;
    for (const auto& geometry : geometries()) {
        // Directions with at most two non-zeros guarantee comparisons, not containment: their single rounding
        // is allowed.
        if (geometry.rounding != Rounding::safe) continue;
        PreparedTrees on_device(device("host"), scene, geometry, 4, 1);
        on_device.update(frame);
        checked += geometry.precision == Precision::fp64
                       ? check_roots<double>(scene, frame, on_device, 0x1p-52L)
                       : check_roots<float>(scene, frame, on_device, 0x1p-23L);
    }
    EXPECT_GT(checked, 10000u);
}

TEST(Bounds, HostAndOpenclHaveEqualBits) {
    const auto scene = crowd(62, 9, 3.0);
    std::uint64_t bytes = 0;
    for (const auto& geometry : geometries()) {
        for (const std::uint32_t leaves : {2u, 32u, 256u}) {
            // In short form only the values of k that have every kind of direction, and the default with
            // every size.
            if (!long_form() && geometry.k != 18 && (leaves != 32 || (geometry.k != 8 && geometry.k != 26)))
                continue;
            PreparedTrees host(device("host"), scene, geometry, leaves, 1);
            PreparedTrees opencl(device("opencl:0"), scene, geometry, leaves, 64);
            for (std::size_t i = 0; i < scene.frame_count; ++i) {
                host.update(scene.frame(i));
                opencl.update(scene.frame(i));
                const auto slots = static_cast<std::size_t>(geometry.k) * real_bytes(geometry);
                const auto a = bytes_in(host, host.trees.nodes(), host.trees.slots());
                const auto b = bytes_in(opencl, opencl.trees.nodes(), opencl.trees.slots());
                EXPECT_EQ(bytes_in(host, host.trees.volumes(), host.bodies.count()),
                          bytes_in(opencl, opencl.trees.volumes(), opencl.bodies.count()));
                for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
                    const std::size_t first = host.trees.first_slot(body);
                    for (const auto& level : host.trees.levels(body)) {
                        for (std::uint32_t slot = 0; slot < 2 * level.items; ++slot) {
                            if (slot % (2 * leaves) == 0) continue; // unused
                            const auto at = (first + level.slot + slot) * slots;
                            ASSERT_EQ(std::memcmp(&a[at], &b[at], slots), 0)
                                << "body " << body << " slot " << slot;
                            bytes += slots;
                        }
                    }
                }
            }
            device("opencl:0").finish();
            device("host").finish();
        }
    }
    fmt::print("{} bytes of nodes equal\n", bytes);
    EXPECT_GT(bytes, 1000000u);
}

TEST(Bounds, MemoryStaysWithinItsBudget) {
    for (const std::string key : {"pile:bodies=50,frames=1", "plates:count=50,frames=1"}) {
        const auto scene = make_scene(key);
        for (const auto& geometry : geometries()) {
            auto& on = device("host");
            const auto before = on.bytes_allocated();
            const PreparedTrees on_device(on, scene, geometry, 32, 1);
            const auto real = real_bytes(geometry);
            const auto node = real * static_cast<std::size_t>(geometry.k) + 8;
            const auto topology = scene.meshes.front().tetrahedra.size() * 32
                                  + scene.meshes.front().vertices.size() * 4 * real + 4096;
            EXPECT_LE(on.bytes_allocated() - before,
                      node * (on_device.trees.slots() + on_device.bodies.count())
                          + 4 * real * vertex_count(scene) + topology)
                << key;
        }
    }
}

TEST(Bounds, FixedBodiesAreRefittedOnce) {
    const auto scene = crowd(63, 6, 1.0);
    auto& on = device("host");
    PreparedTrees on_device(on, scene, {}, 8, 1);
    const auto groups_of = [&] {
        on.set_clocks(Clocks::on);
        on_device.update(scene.frame(0));
        std::uint64_t groups = 0;
        for (const auto& event : on.finish().events)
            groups += event.label == "refit_strips" ? event.groups : 0;
        on.set_clocks(Clocks::off);
        return groups;
    };
    const auto first = groups_of();
    const auto second = groups_of();
    EXPECT_GT(second, 0u);
    EXPECT_LT(second, first);
}

} // namespace
} // namespace tandem
