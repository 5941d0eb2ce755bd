// SPDX-License-Identifier: MIT
// Hard cases with pressure fields (field=1): the polygons of every family are those of the reference, and
// close to those of rational arithmetic.
#include "algorithms/bodies/origin.h"
#include "algorithms/narrow_phase/contact_settings.h"
#include "geometry/exact_polygon.h"
#include "harness/verify/oracle/frame_truth.h"
#include "scenes/hard/hard.h"
#include "scenes/digest.h"
#include "tests/support/message_of.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

std::string with_field(const HardFamily& family) {
    const auto* pairs = family.scene != nullptr ? "" : "pairs=36,together=18,";
    return fmt::format("hard:{}:{}field=1", family.name, pairs);
}

class HardPolygons : public OnDevice {
protected:
    /// Compares the first frame with the reference, and returns its polygons.
    std::vector<ContactPoint> expect_right(const Scene& scene, SettingTexts given) {
        given["contact_rule"] = "pressure";
        given["pair_capacity"] = "8192";
        const auto session = prepare(algorithm("tiled"), scene, given);
        const auto frame = counted_from(session->origin(), scene.frame(0));
        const auto right = reference(scene, frame, geometry_of(session->settings()), true,
                                     Method::brute_force, contact_settings_of(session->settings()));
        const auto result = session->run(scene.frame(0));
        EXPECT_EQ(result.contact_digest(), right.contact_digest);
        EXPECT_EQ(result.contacts, right.contacts);
        return result.download_contacts();
    }
};

TEST_P(HardPolygons, AreThoseOfTheReference) {
    std::size_t polygons = 0, with_polygons = 0;
    std::set<std::string> refused; // because float cannot hold their areas
    for (const auto& family : hard_families()) {
        if (family.name == "not-finite" || family.name == "counter-wrap") continue;
        SCOPED_TRACE(family.name);
        const auto scene = make_scene(with_field(family));
        for (const auto& mesh : scene.meshes) ASSERT_GT(std::ranges::min(mesh.pressures), 0);
        for (const std::string precision : {"float", "double"}) {
            if (!long_form() && GetParam() != "host" && precision == "double") continue;
            const SettingTexts given{{"precision", precision}, {"origin", family.distant ? "auto" : "world"}};
            std::vector<ContactPoint> rows;
            const auto message = message_of([&] { rows = expect_right(scene, given); });
            if (message != "no error") {
                EXPECT_EQ(precision, "float");
                EXPECT_THAT(message, AnyOf(HasSubstr("areas of surfaces"), HasSubstr("surfaces have areas")));
                refused.emplace(family.name);
            }
            polygons += rows.size();
            with_polygons += rows.empty() ? 0 : 1;
        }
    }
    EXPECT_THAT(refused, UnorderedElementsAre("scale", "subnormal"));
    EXPECT_GT(polygons, 1000u);
    EXPECT_GT(with_polygons, 30u);
}

/// Appends a tetrahedron, whose corners are rounded to float.
void append(Mesh& mesh, const std::array<Eigen::Vector3d, 4>& corners) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const auto& corner : corners) mesh.vertices.emplace_back(corner.cast<float>().cast<double>());
    mesh.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
}

/// The linear pressure of the mesh's last tetrahedron at a place.
double pressure_at(const Mesh& mesh, const Eigen::Vector3d& place) {
    Eigen::Matrix4d corners;
    Eigen::Vector4d values;
    for (int i = 0; i < 4; ++i) {
        corners.row(i) << mesh.vertices[mesh.vertices.size() - 4 + i].transpose(), 1;
        values[i] = mesh.pressures[mesh.pressures.size() - 4 + i];
    }
    const Eigen::Vector4d linear = corners.fullPivLu().solve(values);
    return linear.head<3>().dot(place) + linear[3];
}

/// Pairs of tetrahedra, a small one in a large one, far from all others. A face of the small one lies in the
/// plane of equal pressure but for the rounding of its pressures.
Scene planes_through_faces(std::uint32_t pairs) {
    Random random(3);
    Scene scene;
    scene.name = scene.key = "planes_through_faces";
    scene.meshes.resize(2);
    auto& large = scene.meshes[0];
    auto& small = scene.meshes[1];
    for (std::uint32_t i = 0; i < pairs; ++i) {
        const Eigen::Vector3d center(5. * (i % 16) + 1, 5. * (i / 16 % 16) + 1, 5. * (i / 256) + 1);
        const auto turn = random.rotation();
        const auto placed = [&](double x, double y, double z) -> Eigen::Vector3d {
            return center + turn * Eigen::Vector3d(x, y, z);
        };
        append(large, {placed(2, 0, -1.4), placed(-2, 0, -1.4), placed(0, 2, 1.4), placed(0, -2, 1.4)});
        for (int k = 0; k < 4; ++k) large.pressures.push_back(random.uniform(1, 2));
        const auto near = [&]() -> Eigen::Vector3d { return center + 0.2 * random.direction(); };
        append(small, {near(), near(), near(), near()});
        for (int k = 0; k < 4; ++k)
            small.pressures.push_back(pressure_at(large, small.vertices[small.vertices.size() - 4 + k]));
        small.pressures.back() += i % 2 == 0 ? 0.5 : -0.5;
    }
    for (auto* mesh : {&large, &small}) complete_mesh(*mesh, scene.name);
    scene.bodies = {{.mesh = 0}, {.mesh = 1}};
    scene.frame_count = 1;
    scene.frame = [](std::size_t) { return Frame{.poses = {{}, {}}, .deformed = {{}, {}}}; };
    scene.digest = digest_of(scene);
    return scene;
}

/// Whoever takes the roundings of such a plane for its distance loses polygons.
TEST_P(HardPolygons, OfPlanesThroughAFaceAreThoseOfTheReference) {
    const auto scene = planes_through_faces(600);
    for (const std::string precision : {"float", "double"})
        EXPECT_GT(expect_right(scene, {{"precision", precision}, {"origin", "world"}}).size(), 150u);
}

double longest_edge(const TetraCorners& corners) {
    double most = 0;
    for (const auto& p : corners)
        for (const auto& q : corners)
            most = std::max(most, (Eigen::Vector3d(p.data()) - Eigen::Vector3d(q.data())).norm());
    return most;
}

/// The least height over the longest edge.
double thickness(const TetraCorners& corners) {
    double least = std::numeric_limits<double>::infinity();
    const auto corner = [&](unsigned i) { return Eigen::Vector3d(corners[i % 4].data()); };
    for (unsigned i = 0; i < 4; ++i) {
        const auto normal = (corner(i + 2) - corner(i + 1)).cross(corner(i + 3) - corner(i + 1));
        least = std::min(least, std::abs(normal.normalized().dot(corner(i) - corner(i + 1))));
    }
    return least / longest_edge(corners);
}

/// The polygon of a pair of deformable bodies in rationals, and the unit of its error.
struct Truth {
    Truth(const Scene& scene, const Frame& frame, const Pair& pair) {
        std::array<TetraCorners, 2> corners;
        std::array<std::array<double, 4>, 2> pressures;
        for (unsigned body = 0; body < 2; ++body)
            for (unsigned i = 0; i < 4; ++i) {
                const auto& mesh = scene.meshes[body];
                const auto vertex = mesh.tetrahedra[body == 0 ? pair.tet_a : pair.tet_b][i];
                std::copy_n(frame.deformed[body][vertex].data(), 3, corners[body][i].begin());
                pressures[body][i] = mesh.pressures[vertex];
            }
        const auto polygon = exact_polygon(corners[0], pressures[0], corners[1], pressures[1]);
        area = polygon ? polygon->area : 0;
        const double length = std::max(longest_edge(corners[0]), longest_edge(corners[1]));
        thinnest = std::min(thickness(corners[0]), thickness(corners[1]));
        unit = 0x1p-53 * length * length;
    }

    double area = 0, thinnest = 0, unit = 0;
};

/// Areas err by a few u L^2 over the thickness, in double: what rounding shifts out of a tetrahedron or into
/// it.
TEST(HardPolygonErrors, AreSmall) {
    std::size_t polygons = 0, thin = 0;
    for (const auto& family : hard_families()) {
        if (family.pair == nullptr || family.pose != nullptr || family.name == "not-finite") continue;
        SCOPED_TRACE(family.name);
        const auto scene = make_scene(with_field(family));
        const auto frame = scene.frame(0);
        const auto session =
            prepare_on(device("host"), algorithm("tiled"), scene,
                       {{"contact_rule", "pressure"}, {"precision", "double"}, {"origin", "world"}});
        std::map<Pair, double> areas;
        for (const auto& row : session->run(frame).download_contacts()) areas[row.pair] = row.depth;
        for (const auto& pair : frame_truth(scene, frame, Positions(Precision::fp64)).overlapping) {
            const Truth truth(scene, frame, pair);
            const double error = std::abs(areas[pair] - truth.area) / truth.unit * truth.thinnest;
            EXPECT_LT(error, 4);
            polygons += truth.area > 0 ? 1 : 0;
            thin += truth.area > 0 && truth.thinnest < 1e-6 ? 1 : 0;
        }
    }
    EXPECT_GT(polygons, 1000u);
    EXPECT_GT(thin, 20u);
}

TEST(HardFields, AreDeterministicAndOptional) {
    const auto one = make_scene("hard:deep:field=1"), again = make_scene("hard:deep:field=1"),
               other = make_scene("hard:deep:field=1,seed=2"), none = make_scene("hard:deep");
    EXPECT_EQ(one.meshes[0].pressures, again.meshes[0].pressures);
    EXPECT_NE(one.meshes[0].pressures, other.meshes[0].pressures);
    EXPECT_NE(one.meshes[0].pressures, one.meshes[1].pressures);
    EXPECT_EQ(one.meshes[0].vertices, none.meshes[0].vertices);
    EXPECT_TRUE(none.meshes[0].pressures.empty());
    EXPECT_EQ(none.key.find("field"), std::string::npos) << "keys of records without the parameter stay";
    EXPECT_NE(one.digest, none.digest);
}

TANDEM_ON_DEVICES(HardPolygons);

} // namespace
} // namespace tandem
