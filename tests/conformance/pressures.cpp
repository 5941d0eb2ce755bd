// SPDX-License-Identifier: MIT
// contact_rule=pressure: by every algorithm the polygons of the reference, under any order, capacity, limit
// of memory, number of devices and origin, of meshes with a field only.
#include "tests/support/limited.h"
#include "tests/support/message_of.h"
#include "tests/support/on_device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::HasSubstr;

SettingTexts of_pressure(SettingTexts given = {}) {
    given.emplace("contact_rule", "pressure");
    return given;
}

class PressuresOf : public OnDevice {
protected:
    /// The reference's answer to frame `number`, which the session must equal.
    ReferenceAnswer expect_right(const Traversal& traversal, const Scene& scene, const SettingTexts& given,
                                 std::size_t number = 0) {
        SCOPED_TRACE(std::string(traversal.name()) + text(given));
        const auto frame = scene.frame(number);
        const auto session = prepare(traversal, scene, given);
        auto right = reference(scene, frame, geometry_of(session->settings()), true, Method::brute_force,
                               contact_settings_of(session->settings()));
        const auto result = session->run(frame);
        EXPECT_EQ(result.digest(), right.digest);
        EXPECT_EQ(result.contact_digest(), right.contact_digest);
        EXPECT_EQ(result.contacts, right.contacts);
        EXPECT_EQ(result.degenerate, right.degenerate);
        EXPECT_EQ(result.rejected, right.rejected);
        return right;
    }

    Scene scene_ = crowd(21, 8, 0.8);
};

TEST_P(PressuresOf, EveryAlgorithmHasThePolygonsOfTheReference) {
    std::vector<SettingTexts> cells{{},
                                    {{"order", "canonical"}, {"broad", "device"}, {"contact_capacity", "1"}}};
    if (walks().size() > 2) {
        cells.push_back({{"precision", "double"}, {"k", "6"}, {"decision", "exact"}});
        cells.push_back({{"pair_layout", "items"}, {"decision", "none"}, {"pair_capacity", "1"}});
        cells.push_back({{"decision", "fp32"}, {"placement", "exact"}, {"output", "contacts"}});
    }
    for (const auto* traversal : walks())
        for (const auto& cell : cells)
            EXPECT_GT(expect_right(*traversal, scene_, of_pressure(cell)).contacts, 500u);
}

/// Nodes that bound pressures leave out candidate pairs, and no polygon. k = 18, for which every device has
/// such nodes.
TEST_P(PressuresOf, SlabsOfPressuresLeaveOutNoPolygon) {
    std::vector<SettingTexts> cells{{{"order", "canonical"}, {"broad", "device"}, {"pair_capacity", "1"}}};
    if (!compiles_briefly()) {
        cells.emplace_back();
        cells.push_back({{"precision", "double"}, {"decision", "exact"}});
        cells.push_back({{"placement", "exact"}, {"pair_layout", "items"}, {"output", "contacts"}});
    }
    for (const auto* traversal : walks())
        for (auto cell : cells) {
            const auto whole = expect_right(*traversal, scene_, of_pressure(cell));
            cell["pressure_slab"] = "on";
            const auto part = expect_right(*traversal, scene_, of_pressure(cell));
            EXPECT_EQ(part.contacts, whole.contacts);
            EXPECT_EQ(part.contact_digest, whole.contact_digest);
            EXPECT_LT(part.digest.count, whole.digest.count);
            EXPECT_EQ(whole.rejected - part.rejected, whole.digest.count - part.digest.count);
        }
}

TEST_P(PressuresOf, SlabsOfPressuresAreOfEveryKind) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto& tiled = algorithm("tiled");
    for (const std::string slabs : {"three", "all", "touched"})
        for (const std::string k : {"6", "8", "12", "18", "26"}) {
            if (on.info().max_group_size == 1 && k != "18") continue;
            expect_right(tiled, scene_, of_pressure({{"pressure_slab", "on"}, {"slabs", slabs}, {"k", k}}));
        }
}

TEST_P(PressuresOf, DecisionsDoNotChangePolygons) {
    const auto& tiled = algorithm("tiled");
    const auto exact = expect_right(tiled, scene_, of_pressure({{"decision", "exact"}}));
    for (const std::string decision : {"fp32", "fp64", "recheck", "none"})
        EXPECT_EQ(expect_right(tiled, scene_, of_pressure({{"decision", decision}})).contact_digest,
                  exact.contact_digest)
            << decision;
}

TEST_P(PressuresOf, BodiesWithoutAFieldMakeNone) {
    auto scene = scene_;
    scene.meshes[1].pressures.clear();
    for (const auto* traversal : walks()) {
        const auto rows = prepare(*traversal, scene, of_pressure())->run(scene.frame(0)).download_contacts();
        EXPECT_GT(rows.size(), 100u);
        for (const auto& row : rows) {
            EXPECT_NE(scene.bodies[row.pair.body_a].mesh, 1u);
            EXPECT_NE(scene.bodies[row.pair.body_b].mesh, 1u);
        }
        expect_right(*traversal, scene, of_pressure());
    }
}

/// The deformable body's vertices are uploaded in every frame, its pressures with them.
TEST_P(PressuresOf, DeformableBodiesKeepTheirField) {
    const auto& tiled = algorithm("tiled");
    const auto session = prepare(tiled, scene_, of_pressure());
    for (const std::size_t number : {0u, 1u, 0u}) {
        const auto frame = scene_.frame(number);
        const auto right = reference(scene_, frame, geometry_of(session->settings()), true,
                                     Method::brute_force, contact_settings_of(session->settings()));
        const auto result = session->run(frame);
        EXPECT_EQ(result.contact_digest(), right.contact_digest) << number;
        const auto rows = result.download_contacts();
        EXPECT_TRUE(std::ranges::any_of(
            rows, [](const auto& row) { return row.pair.body_a == 1 || row.pair.body_b == 1; }));
    }
}

TEST_P(PressuresOf, BatchesHaveTheSamePolygons) {
    const auto scene = procession(12, 2, 0.02);
    const auto frame = scene.frame(1);
    std::size_t in_batches = 0;
    for (const auto* traversal : walks()) {
        SCOPED_TRACE(traversal->name());
        const auto given = of_pressure({{"pair_capacity", "500"}, {"contact_capacity", "50"}});
        const Answer right(prepare(*traversal, scene, given)->run(frame));
        const auto least = least_bytes(on, *traversal, scene, given);
        for (const double factor : {1.05, 1.2, 1.5, 2.0}) {
            const Limited limited(on, static_cast<std::size_t>(factor * static_cast<double>(least)));
            try {
                const auto result = prepare(*traversal, scene, given)->run(frame);
                in_batches += result.batches > 1 ? 1 : 0;
                EXPECT_EQ(Answer(result), right) << factor;
            } catch (const OutOfMemory&) {}
        }
    }
    EXPECT_GT(in_batches, 0u);
}

TEST_P(PressuresOf, TwoDevicesHaveTheSamePolygons) {
    const auto& tiled = algorithm("tiled");
    const auto settings = resolved(tiled, of_pressure());
    const auto one = prepare_on(on, tiled, scene_, settings)->run(scene_.frame(0));
    const std::array both{&device("host"), &device("opencl:0")};
    const auto two = tiled.prepare(both, scene_, settings)->run(scene_.frame(0));
    EXPECT_GT(one.contacts, 500u);
    EXPECT_EQ(two.contacts, one.contacts);
    EXPECT_EQ(two.contact_digest(), one.contact_digest());
}

/// Powers of two scale pressures and areas exactly, and centroids do not depend on the field's unit.
TEST_P(PressuresOf, UnitsScaleRows) {
    auto scaled = scene_;
    for (auto& mesh : scaled.meshes)
        for (double& pressure : mesh.pressures) pressure *= 0x1p60;
    const auto& tiled = algorithm("tiled");
    const auto given = of_pressure({{"order", "canonical"}});
    const auto rows = prepare(tiled, scene_, given)->run(scene_.frame(0)).download_contacts();
    const auto others = prepare(tiled, scaled, given)->run(scene_.frame(0)).download_contacts();
    ASSERT_EQ(rows.size(), others.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].point, others[i].point);
        EXPECT_EQ(rows[i].normal, others[i].normal);
        EXPECT_EQ(rows[i].depth, others[i].depth);
        EXPECT_EQ(rows[i].pressure * 0x1p60, others[i].pressure);
    }
}

TEST_P(PressuresOf, ImpossibleSettingsAreRefused) {
    const auto& chunked = algorithm("chunked");
    const auto refusal = [&](const Scene& scene, SettingTexts given) {
        return message_of([&] { prepare(chunked, scene, of_pressure(std::move(given))); });
    };
    EXPECT_THAT(refusal(scene_, {{"contact_rule", "sat"}, {"pressure_slab", "on"}}),
                HasSubstr("pressure_slab=on does not go with contact_rule=sat"));
    if (on.info().max_group_size == 1) {
        EXPECT_THAT(refusal(scene_, {{"k", "6"}, {"pressure_slab", "on"}}), HasSubstr("goes with k=18"));
    }
    EXPECT_THAT(refusal(scene_, {{"self", "on"}}),
                HasSubstr("self=on does not go with contact_rule=pressure"));
    EXPECT_THAT(refusal(scene_, {{"motion", "linear"}, {"decision", "exact"}}),
                HasSubstr("motion=linear does not go with contact_rule=pressure"));
    EXPECT_THAT(refusal(scene_, {{"residency", "published"}}),
                HasSubstr("contact_rule=pressure does not go with residency=published"));
    auto bare = scene_;
    for (auto& mesh : bare.meshes) mesh.pressures.clear();
    EXPECT_THAT(refusal(bare, {}), HasSubstr("needs a pressure field, and no mesh of scene crowd has one"));
}

TANDEM_ON_DEVICES(PressuresOf);

} // namespace
} // namespace tandem
