// SPDX-License-Identifier: MIT
// output=contacts, which leaves interior tetrahedra out: the contacts of output=pairs, bit by bit, and the
// candidate pairs whose tetrahedra have boundary faces.
#include "algorithms/baselines/embree/embree_stages.h"
#include "algorithms/narrow_phase/contact_settings.h"
#include "harness/verify/reference.h"
#include "scenes/builtin.h"
#include "tests/support/flawed.h"
#include "tests/support/frames_there.h"
#include "tests/support/limited.h"
#include "tests/support/long_form.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

/// The contacts of an answer, in an order without meaning.
std::vector<std::tuple<Pair, std::uint32_t, std::array<double, 7>>> contacts_of(const FrameResult& result) {
    std::vector<std::tuple<Pair, std::uint32_t, std::array<double, 7>>> all;
    for (const auto& c : result.download_contacts())
        all.push_back({c.pair,
                       c.feature,
                       {c.point[0], c.point[1], c.point[2], c.normal[0], c.normal[1], c.normal[2], c.depth}});
    std::ranges::sort(all);
    return all;
}

/// Frames that skip nothing, interior and boundary tetrahedra, most of a body, and again nothing.
std::vector<Frame> frames_with_gaps(const Scene& scene) {
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < 4; ++i) {
        frames.push_back(scene.frame(i % scene.frame_count));
        if (i == 0 || i == 3) continue;
        frames.back().skipped.resize(scene.bodies.size());
        for (std::size_t body = 0; body < scene.bodies.size(); ++body)
            for (std::uint32_t t = 0; t < scene.meshes[scene.bodies[body].mesh].tetrahedra.size(); ++t)
                if (i == 1 ? t % 3 == body % 3 : body == 1 && t % 9 != 0)
                    frames.back().skipped[body].push_back(t);
    }
    return frames;
}

class Interior : public OnDevice {
protected:
    std::unique_ptr<Session> prepare(const Traversal& traversal, const Scene& scene, SettingTexts given,
                                     const std::string& output) const {
        given["output"] = output;
        return prepare_on(on, traversal, scene, given);
    }

    /// `result`: of output=contacts, `whole`: of output=pairs.
    static void expect_equal(const Scene& scene, const FrameResult& result, const FrameResult& whole) {
        EXPECT_EQ(result.contacts, whole.contacts);
        EXPECT_EQ(result.contact_digest(), whole.contact_digest());
        EXPECT_EQ(contacts_of(result), contacts_of(whole));
        EXPECT_EQ(result.download(), of_boundary(scene, whole.download()));
        EXPECT_LT(result.count, whole.count);
        EXPECT_GT(result.contacts, 0u);
    }

    /// Frames of the scene with both outputs, and the reference of output=contacts.
    void expect_same_contacts(const Traversal& traversal, const Scene& scene,
                              const SettingTexts& given) const {
        SCOPED_TRACE(fmt::format("{}{}", traversal.name(), text(given)));
        const auto fewer = prepare(traversal, scene, given, "contacts");
        const auto all = prepare(traversal, scene, given, "pairs");
        const auto& settings = fewer->settings();
        ASSERT_EQ(walked_of(settings), Walked::boundary);
        for (const auto& frame : frames_with_gaps(scene)) {
            const auto result = run_among_all(*fewer, scene, frame);
            expect_equal(scene, result, run_among_all(*all, scene, frame));
            const auto right = reference(scene, frame, geometry_of(settings), true, Method::brute_force,
                                         contact_settings_of(settings));
            expect_same_digests(result, right);
            EXPECT_EQ(result.without_boundary, right.without_boundary);
            EXPECT_EQ(result.rejected, right.rejected);
            EXPECT_EQ(result.undecided_by_filter, right.undecided_by_filter);
        }
    }
};

TEST_P(Interior, MakesTheSameContactsWithEveryAlgorithm) {
    const auto scene = boxes_scene(4, 4);
    for (const auto* traversal : walks())
        for (const std::string rule : {"opposing", "published"})
            expect_same_contacts(*traversal, scene, {{"contact_rule", rule}, {"broad", "device"}});
    if (GetParam() == "host" && embree_absence().empty())
        expect_same_contacts(algorithm("embree"), scene, {{"k", "6"}, {"broad", "device"}});
}

TEST_P(Interior, MakesTheSameContactsWithEverySetting) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = boxes_scene(3, 4);
    std::size_t cell = 0;
    for (const std::string builder : {"morton", "sah", "breadth", "hilbert", "median", "balanced"})
        for (const std::string decision : {"fp32", "recheck", "exact"})
            expect_same_contacts(algorithm(cell++ % 2 == 0 ? "tiled" : "chunked"), scene,
                                 {{"builder", builder},
                                  {"decision", decision},
                                  {"k", cell % 3 == 0 ? "8" : "18"},
                                  {"precision", cell % 4 == 0 ? "double" : "float"},
                                  {"placement", cell % 5 == 0 ? "exact" : "rounded"},
                                  {"pair_capacity", "1"},
                                  {"contact_capacity", "1"}});
}

/// Batches are of body pairs, whose candidate pairs are estimated from walked tetrahedra.
TEST_P(Interior, MakesTheSameContactsInBatches) {
    const auto scene = crowd(71, 10, 0.9);
    const auto frame = scene.frame(0);
    for (const auto* traversal : walks()) {
        const SettingTexts given{{"broad", "device"}, {"k", "8"}, {"output", "contacts"}};
        SCOPED_TRACE(traversal->name());
        const auto whole = prepare(*traversal, scene, given, "pairs")->run(frame);
        const Limited limit(on, least_bytes(on, *traversal, scene, given) + whole.contacts * 8);
        const auto result = prepare_on(on, *traversal, scene, given)->run(frame);
        EXPECT_GT(result.batches, 1u);
        expect_equal(scene, result, whole);
    }
}

/// Vertices of interior tetrahedra only are not read.
TEST_P(Interior, MakesTheSameContactsFromDeviceMemory) {
    const auto scene = boxes_scene(4, 4);
    const SettingTexts given{{"broad", "device"}};
    const auto fewer = prepare(algorithm("tiled"), scene, given, "contacts");
    const auto all = prepare(algorithm("tiled"), scene, given, "pairs");
    for (std::size_t i = 0; i < 3; ++i) {
        const Rows rows(scene.frame(i), i % 2 == 1);
        expect_equal(scene, fewer->run(rows.uploaded_to(on)), all->run(rows.host));
    }
}

/// Other rules make contacts of interior tetrahedra, and the paper's data path has everything in its arrays.
TEST_P(Interior, IsWalkedWhereItMakesContacts) {
    const auto scene = boxes_scene(3, 4);
    const auto frame = scene.frame(0);
    for (const SettingTexts& given :
         {SettingTexts{{"contact_rule", "sat"}}, SettingTexts{{"contact_rule", "vertex"}},
          SettingTexts{{"residency", "published"}}}) {
        SCOPED_TRACE(text(given));
        const auto result =
            run_among_all(*prepare(algorithm("chunked"), scene, given, "contacts"), scene, frame);
        const auto whole = run_among_all(*prepare(algorithm("chunked"), scene, given, "pairs"), scene, frame);
        expect_same_digests(result, whole);
        EXPECT_GT(result.contacts, 0u);
    }
}

/// A tetrahedron, and four that fill it from a vertex inside, share all faces: the boundary of a simplex of
/// four dimensions. Such a mesh is walked whole, and makes no contacts.
TEST_P(Interior, IsWalkedInAMeshWithoutBoundary) {
    auto scene = boxes_scene(3, 4);
    auto& mesh = scene.meshes[0];
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.2, 0.2, 0.2}};
    mesh.tetrahedra = {{0, 1, 2, 3}, {4, 1, 2, 3}, {0, 4, 2, 3}, {0, 1, 4, 3}, {0, 1, 2, 4}};
    complete_mesh(mesh, "closed");
    ASSERT_THAT(mesh.boundary, testing::Each(0));
    for (const auto* traversal : walks()) {
        const auto result =
            prepare(*traversal, scene, {{"broad", "device"}}, "contacts")->run(scene.frame(0));
        const auto whole = prepare(*traversal, scene, {{"broad", "device"}}, "pairs")->run(scene.frame(0));
        EXPECT_EQ(result.download(), of_boundary(scene, whole.download()));
        EXPECT_GT(result.count, 0u);
        EXPECT_EQ(result.without_boundary, result.count);
        EXPECT_EQ(result.contacts, 0u);
    }
}

TEST_P(Interior, IsAnErrorWithoutAContactRule) {
    EXPECT_THAT(
        [&] {
            prepare(algorithm("tiled"), boxes_scene(3, 4), {{"contact_rule", "none"}}, "contacts");
        },
        testing::ThrowsMessage<InputError>(testing::HasSubstr("needs a contact rule")));
}

TANDEM_ON_DEVICES(Interior);

/// Each device has its part of the bodies.
TEST(InteriorOfParts, MakesTheSameContactsOnTwoDevices) {
    const auto scene = procession(24, 4, 0.35);
    const std::array both{&device("host"), &device("opencl:0")};
    const std::array one{&device("host")};
    for (const auto* traversal : walks(!long_form())) {
        SCOPED_TRACE(traversal->name());
        const auto settings = [&](const std::string& output) {
            return resolved(*traversal, {{"broad", "device"}, {"output", output}});
        };
        const auto fewer = traversal->prepare(both, scene, settings("contacts"));
        const auto all = traversal->prepare(one, scene, settings("pairs"));
        for (const std::size_t i : {0u, 1u, 3u}) {
            const auto result = fewer->run(scene.frame(i)), whole = all->run(scene.frame(i));
            EXPECT_EQ(result.download(), of_boundary(scene, whole.download()));
            EXPECT_EQ(result.contact_digest(), whole.contact_digest());
            EXPECT_LT(result.count, whole.count);
        }
    }
}

} // namespace
} // namespace tandem
