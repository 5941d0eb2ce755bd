// SPDX-License-Identifier: MIT
#include "harness/verify/accuracy/answer_errors.h"
#include "harness/verify/accuracy/hull.h"
#include "harness/verify/accuracy/truths.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using Point = std::array<double, 3>;

const TetraCorners unit{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

TEST(Hull, DistanceOfPointsFromATetrahedron) {
    EXPECT_DOUBLE_EQ(distance_to_hull(unit, {-2, 0.2, 0.3}), 2);             // a face
    EXPECT_DOUBLE_EQ(distance_to_hull(unit, {0.5, -3, -4}), 5);              // an edge
    EXPECT_DOUBLE_EQ(distance_to_hull(unit, {4, -4, 0}), 5);                 // a corner
    EXPECT_NEAR(distance_to_hull(unit, {1, 1, 1}), 2 / std::sqrt(3), 1e-15); // the slanted face
    EXPECT_NEAR(distance_to_hull(unit, {0.2, 0.2, 0.2}), 0, 1e-15);          // inside
    EXPECT_NEAR(distance_to_hull(unit, {0.25, 0.25, 0}), 0, 1e-15);          // in a face
}

TEST(Hull, DistanceFromFewPoints) {
    const std::vector<Point> one{{1, 2, 3}};
    const std::vector<Point> two{{-1, 2, 0}, {1, 2, 0}};
    const std::vector<Point> flat{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}};
    EXPECT_DOUBLE_EQ(distance_to_hull(one, {1, 2, 7}), 4);
    EXPECT_DOUBLE_EQ(distance_to_hull(two, {0, 0, 0}), 2);
    EXPECT_NEAR(distance_to_hull(flat, {0.3, 0.9, -2}), 2, 1e-15);
}

/// Points between two hull points are in the hull; points beyond the extreme point along a direction are not.
TEST(Hull, AgreesWithConvexCombinations) {
    Random random(5);
    for (int i = 0; i < 500; ++i) {
        std::vector<Point> points(4 + random.next() % 8);
        for (auto& p : points)
            for (auto& x : p) x = random.uniform();
        Point inside{};
        double sum = 0;
        for (const auto& p : points) {
            const double weight = random.uniform();
            sum += weight;
            for (int c = 0; c < 3; ++c) inside[c] += weight * p[c];
        }
        for (auto& x : inside) x /= sum;
        EXPECT_LT(distance_to_hull(points, inside), 1e-7);
        const auto direction = random.direction();
        const auto along = [&](const Point& p) {
            return p[0] * direction.x() + p[1] * direction.y() + p[2] * direction.z();
        };
        const auto top = *std::max_element(points.begin(), points.end(),
                                           [&](const auto& p, const auto& q) { return along(p) < along(q); });
        const Point above{top[0] + 3 * direction.x(), top[1] + 3 * direction.y(), top[2] + 3 * direction.z()};
        EXPECT_NEAR(distance_to_hull(points, above), 3, 1e-12);
    }
}

TEST(Hull, HausdorffIsTheLargerOfBothSides) {
    const std::vector<Point> p{{0, 0, 0}, {1, 0, 0}};
    const std::vector<Point> q{{0, 0, 0}, {1, 0, 0}, {0, 5, 0}};
    EXPECT_DOUBLE_EQ(hausdorff_distance(p, q), 5);
    EXPECT_DOUBLE_EQ(hausdorff_distance(q, p), 5);
    EXPECT_DOUBLE_EQ(hausdorff_distance(p, p), 0);
}

/// The unit tetrahedron and a copy moved along x; body 0 is at the origin.
Scene two_units(double x) {
    Scene scene;
    scene.name = scene.key = "two";
    Mesh mesh;
    for (const auto& c : unit) mesh.vertices.emplace_back(c[0], c[1], c[2]);
    mesh.tetrahedra = {{0, 1, 2, 3}};
    complete_mesh(mesh, "unit");
    scene.meshes = {mesh};
    scene.bodies = {{}, {}};
    scene.frame_count = 1;
    scene.frame = [x](std::size_t) {
        Frame frame;
        frame.poses = {{}, {Eigen::Quaterniond::Identity(), {x, 0, 0}}};
        frame.deformed.resize(2);
        return frame;
    };
    return scene;
}

const Pair the_pair{0, 0, 1, 0};

/// Errors of an answer for the two tetrahedra: `pairs` with `contacts`.
AnswerErrors errors_of(double x, std::vector<Pair> pairs, std::vector<ContactPoint> contacts,
                       bool measures = false) {
    const auto scene = two_units(x);
    const FrameRange range(scene, 0, 0);
    Truths truths(scene, range, TruthAmount::contacts, 0);
    FrameAnswer answer;
    answer.makes_contacts = true;
    answer.measures = measures;
    answer.download = [&] { return pairs; };
    answer.download_contacts = [&] { return contacts; };
    return truths.errors(Geometry{}, 0, answer);
}

/// Moved by 3/4 along x, the two share a tetrahedron with legs of 1/4 at (3/4, 0, 0). The least translation
/// is along x, as long as the leg, or along (1,1,1): 1/4 / sqrt(3), which is shorter.
TEST(Accuracy, ARightContactHasNoError) {
    const double root = std::sqrt(3.0);
    const auto e = errors_of(0.75, {the_pair},
                             {{the_pair, 0, {0.75, 0, 0}, {1 / root, 1 / root, 1 / root}, -0.25 / root}});
    EXPECT_EQ(e.missed(), 0u);
    EXPECT_EQ(e.pairs.overlapping, 1u);
    EXPECT_EQ((*e.decisions)[2][2], 1u);
    ASSERT_TRUE(e.contacts);
    EXPECT_LT(e.contacts->depth_relative.at(0), 1e-15);
    EXPECT_LT(e.contacts->normal_degrees.at(0), 1e-6);
    EXPECT_LT(e.contacts->point.at(0), 1e-15);
    EXPECT_NEAR(e.contacts->hausdorff.at(0), 0.25 / std::sqrt(2.0), 1e-15); // L is sqrt(2)
    EXPECT_TRUE(e.every_contact);
}

/// The shared tetrahedron with legs of 1/4: all of it, half of it, and only one face.
TEST(Accuracy, VolumesAreThoseOfTheHullOfContactPoints) {
    const auto with = [](const std::vector<Point>& points) {
        std::vector<ContactPoint> contacts;
        for (const auto& p : points)
            contacts.push_back({the_pair, static_cast<std::uint32_t>(contacts.size()), p, {1, 0, 0}, -0.1});
        return errors_of(0.75, {the_pair}, contacts);
    };
    const Point corner{0.75, 0, 0}, x{1, 0, 0}, y{0.75, 0.25, 0}, z{0.75, 0, 0.25};
    EXPECT_EQ(with({corner, x, y, z}).contacts->volume_relative.at(0), 0);
    EXPECT_NEAR(with({corner, x, y, {0.75, 0, 0.125}}).contacts->volume_relative.at(0), 0.5, 1e-15);
    EXPECT_NEAR(with({corner, x, y, {0.75, 0, 0.75}}).contacts->volume_relative.at(0), 2, 1e-15);
    EXPECT_EQ(with({corner, x, y}).contacts->volume_relative.at(0), 1);
    EXPECT_EQ(with({corner, x, y, z}).contacts->no_volume, 0u);
    EXPECT_TRUE(with({}).contacts->volume_relative.empty()); // no contact points
}

/// Float treats a gap or an overlap of 2^-30 as touching. With placement=exact, the poses decide about pairs,
/// decisions and contacts.
TEST(Accuracy, PairsAreComparedWithTheTruthOfTheirPlacement) {
    const Geometry vertices, poses{.placement = Placement::exact};
    for (const double gap : {0x1p-30, -0x1p-30}) {
        const auto scene = two_units(1 + gap);
        const FrameRange range(scene, 0, 0);
        Truths truths(scene, range, TruthAmount::contacts, 0);
        FrameAnswer answer;
        answer.makes_contacts = true;
        answer.download = [] { return std::vector<Pair>{the_pair}; };
        answer.download_contacts = [] { return std::vector<ContactPoint>{}; };
        const auto of_vertices = truths.errors(vertices, 0, answer);
        const auto of_poses = truths.errors(poses, 0, answer);
        EXPECT_EQ(of_vertices.pairs.touching, 1u);
        EXPECT_EQ(of_poses.pairs.disjoint, gap > 0 ? 1u : 0u);
        EXPECT_EQ(of_poses.pairs.overlapping, gap > 0 ? 0u : 1u);
        EXPECT_EQ((*of_vertices.decisions)[1][0], 1u);
        EXPECT_EQ((*of_poses.decisions)[gap > 0 ? 0 : 2][0], 1u);
        EXPECT_EQ(of_vertices.contacts->overlapping, 0u);
        EXPECT_EQ(of_poses.contacts->overlapping, gap > 0 ? 0u : 1u);
        answer.download = [] { return std::vector<Pair>{}; };
        answer.pairs.count = 7; // a different answer
        EXPECT_EQ(truths.errors(vertices, 0, answer).pairs.missed_touching, 1u);
        EXPECT_EQ(truths.errors(poses, 0, answer).pairs.missed_overlapping, gap > 0 ? 0u : 1u);
        EXPECT_EQ(truths.errors(poses, 0, answer).missed(), gap > 0 ? 0u : 1u);
    }
}

/// The shared tetrahedron with legs of 1/4 at 1000.1: floats displace it by 2e-5 unless they are relative to
/// a near origin.
TEST(Accuracy, FarContactsAreComparedInCoordinatesFromTheOrigin) {
    auto scene = two_units(0.75);
    scene.frame = [near = scene.frame](std::size_t i) {
        auto frame = near(i);
        for (auto& pose : frame.poses) pose.translation += Eigen::Vector3d(1000.1, 0, 0);
        return frame;
    };
    const FrameRange range(scene, 0, 0);
    Truths truths(scene, range, TruthAmount::contacts, 0);
    FrameAnswer answer;
    answer.makes_contacts = true;
    answer.download = [] { return std::vector<Pair>{the_pair}; };
    answer.download_contacts = [] {
        std::vector<ContactPoint> contacts;
        for (const Point& p :
             {Point{1000.85, 0, 0}, Point{1001.1, 0, 0}, Point{1000.85, 0.25, 0}, Point{1000.85, 0, 0.25}})
            contacts.push_back({the_pair, static_cast<std::uint32_t>(contacts.size()), p, {1, 0, 0}, -0.1});
        return contacts;
    };
    const auto point = [&](const Geometry& geometry) {
        return truths.errors(geometry, 0, answer).contacts->point.at(0);
    };
    EXPECT_GT(point({}), 1e-5);
    EXPECT_LT(point({.origin = Origin::automatic}), 1e-7);
    EXPECT_LT(point({.placement = Placement::exact}), 1e-11);
    EXPECT_LT(point({.placement = Placement::exact, .origin = Origin::automatic}), 1e-11);
}

/// At 1e-120, the cube of a length underflows in double.
TEST(Accuracy, PairsWhoseVolumeRoundsToZeroAreCountedSeparately) {
    auto scene = two_units(0.75e-120);
    for (auto& v : scene.meshes[0].vertices) v *= 1e-120;
    const FrameRange range(scene, 0, 0);
    Truths truths(scene, range, TruthAmount::contacts, 0);
    FrameAnswer answer;
    answer.makes_contacts = true;
    answer.download = [] { return std::vector<Pair>{the_pair}; };
    answer.download_contacts = [] {
        return std::vector<ContactPoint>{{the_pair, 0, {0.8e-120, 0, 0}, {1, 0, 0}, -0.1e-120}};
    };
    const auto& e = truths.errors({.precision = Precision::fp64}, 0, answer);
    ASSERT_TRUE(e.contacts);
    EXPECT_EQ(e.contacts->overlapping, 1u);
    EXPECT_EQ(e.contacts->no_volume, 1u);
    EXPECT_TRUE(e.contacts->volume_relative.empty());
    EXPECT_EQ(e.contacts->depth_relative.size(), 1u);
}

TEST(Accuracy, AWrongContactHasItsKnownError) {
    const auto e = errors_of(0.75, {the_pair}, {{the_pair, 0, {0.75, 0, -1}, {1, 0, 0}, -0.25}});
    const double exact = 0.25 / std::sqrt(3.0);
    ASSERT_TRUE(e.contacts);
    EXPECT_NEAR(e.contacts->depth_relative.at(0), (0.25 - exact) / exact, 1e-14);
    EXPECT_NEAR(e.contacts->depth_ulps.at(0), (0.25 - exact) / std::sqrt(2.0) * 0x1p24, 1e-6);
    EXPECT_NEAR(e.contacts->normal_degrees.at(0), std::acos(1 / std::sqrt(3.0)) * 180 / M_PI, 1e-12);
    EXPECT_NEAR(e.contacts->point.at(0), 1 / std::sqrt(2.0), 1e-15);
}

TEST(Accuracy, DistancesOfPairsApartHaveTheirErrors) {
    const double longer = std::sqrt(2.0);
    const auto apart =
        errors_of(1.5, {the_pair}, {{the_pair, 0, {1, 0, 0}, {1, 0, 0}, 0.5 + 3 * 0x1p-24 * longer}}, true);
    EXPECT_NEAR(apart.contacts->distance_ulps.at(0), 3, 1e-6);
    EXPECT_EQ((*apart.decisions)[0][0], 1u) << "it answers that the two are apart";
    const auto wrong = errors_of(1.5, {the_pair}, {{the_pair, 0, {1, 0, 0}, {1, 0, 0}, -0.5}}, true);
    EXPECT_EQ((*wrong.decisions)[0][2], 1u);
    const auto deep = errors_of(0.75, {the_pair}, {{the_pair, 0, {1, 0, 0}, {1, 0, 0}, -0.25}}, true);
    EXPECT_TRUE(deep.contacts->distance_ulps.empty());
    EXPECT_EQ(deep.contacts->depth_ulps.size(), 1u);
    EXPECT_TRUE(deep.contacts->point.empty()) << "on A, not in the intersection";
}

TEST(Accuracy, MissedFalseAndUnansweredPairsAreCounted) {
    const auto missed = errors_of(0.75, {}, {});
    EXPECT_EQ(missed.pairs.missed_overlapping, 1u);
    EXPECT_EQ((*missed.decisions)[2][0], 1u);
    EXPECT_EQ(missed.contacts->unanswered, 1u);
    EXPECT_FALSE(missed.missed_upper95());

    const auto apart = errors_of(1.5, {the_pair}, {{the_pair, 0, {1, 0, 0}, {1, 0, 0}, 0}});
    EXPECT_EQ(apart.pairs.disjoint, 1u);
    EXPECT_EQ((*apart.decisions)[0][1], 1u);
    EXPECT_FALSE(apart.candidate_ratio());

    const auto touching = errors_of(1, {the_pair}, {});
    EXPECT_EQ(touching.pairs.touching, 1u);
    EXPECT_EQ((*touching.decisions)[1][0], 1u);
    EXPECT_EQ(touching.contacts->overlapping, 0u);
    EXPECT_EQ(touching.missed_upper95(), 1.0);
}

TEST(Accuracy, NonFiniteNumbersAreCountedAndNotSampled) {
    const auto e = errors_of(0.75, {the_pair}, {{the_pair, 0, {0.75, 0, NAN}, {1, 0, 0}, -0.25}});
    EXPECT_EQ(e.contacts->not_finite, 1u);
    EXPECT_TRUE(e.contacts->depth_relative.empty());
}

TEST(Accuracy, EqualAnswersAreComparedOnceAndTheSampleRecordsIt) {
    const auto scene = crowd(3, 9, 1.2);
    const FrameRange range(scene, 0, 0);
    const auto truth = frame_truth(scene, scene.frame(0), Precision::fp32);
    ASSERT_GT(truth.overlapping.size(), 20u);
    int downloads = 0;
    FrameAnswer answer;
    answer.makes_contacts = true;
    answer.pairs.count = 7;
    answer.download = [&] {
        ++downloads;
        return truth.overlapping;
    };
    answer.download_contacts = [] { return std::vector<ContactPoint>{}; };
    Truths truths(scene, range, TruthAmount::contacts, 10);
    const auto first = truths.errors(Geometry{}, 0, answer);
    truths.errors(Geometry{}, 0, answer);
    EXPECT_EQ(downloads, 1);
    EXPECT_EQ(first.pairs.missed_touching, truth.touching.size());
    EXPECT_FALSE(first.every_contact);
    EXPECT_EQ(first.contacts->overlapping, 10u);
    answer.pairs.a = 1;
    truths.errors(Geometry{}, 0, answer);
    EXPECT_EQ(downloads, 2);
}

TEST(Accuracy, AFailedReadOfAnAnswerIsRetried) {
    const auto scene = crowd(3, 9, 1.2);
    const FrameRange range(scene, 0, 0);
    const auto truth = frame_truth(scene, scene.frame(0), Precision::fp32);
    FrameAnswer answer;
    answer.download = []() -> std::vector<Pair> { throw DeviceError("lost"); };
    Truths truths(scene, range, TruthAmount::pairs, 0);
    EXPECT_THROW(truths.errors(Geometry{}, 0, answer), DeviceError);
    answer.download = [&] { return truth.overlapping; };
    EXPECT_EQ(truths.errors(Geometry{}, 0, answer).pairs.overlapping, truth.overlapping.size());
}

TEST(Accuracy, ErrorsOfFramesAreMerged) {
    AnswerErrors one, other, sum;
    one.pairs = {1, 2, 3, 4, 5, 6, 7};
    other.pairs = {10, 20, 30, 40, 50, 60, 70};
    one.decisions = DecisionMatrix{{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}};
    other.every_contact = false;
    one.contacts.emplace().depth_ulps = {8};
    other.contacts.emplace().depth_ulps = {9};
    one.drift = Drift{1, 2, 3, 4, 5};
    other.drift = Drift{6, 7, 8, 9, 10};
    sum.add(one);
    sum.add(other);
    EXPECT_EQ(sum.pairs, (PairErrors{11, 22, 33, 44, 55, 66, 77}));
    EXPECT_EQ(sum.decisions, one.decisions);
    EXPECT_EQ(sum.contacts->depth_ulps, (std::vector<double>{8, 9}));
    EXPECT_EQ(sum.drift->vertices, 1u); // vertices of the first frame
    EXPECT_FALSE(sum.every_contact);
}

TEST(Accuracy, AnglesAreThoseToTheNearestNormal) {
    const std::vector<Point> normals{{0, 2, 0}, {3, 0, 0}};
    EXPECT_DOUBLE_EQ(nearest_angle(normals, {0.5, 0, 0.5}), 45);
    EXPECT_DOUBLE_EQ(nearest_angle(normals, {1, 1e-9, 0}), 1e-9 * 180 / M_PI);
    EXPECT_DOUBLE_EQ(nearest_angle(std::span(normals).first(1), {0, -1, 0}), 180);
    EXPECT_DOUBLE_EQ(longest_edge({{{0, 0, 0}, {1, 0, 0}, {0, 3, 0}, {0, 0, 4}}}), 5);
}

} // namespace
} // namespace tandem
