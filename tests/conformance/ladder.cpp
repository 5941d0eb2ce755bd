// SPDX-License-Identifier: MIT
// Sizes at which levels, chunks, groups and tiles turn: bodies of 1 to 20,000 tetrahedra, and 1 to 3,000
// bodies, by every algorithm and preset, with pairs of one body, a successor, and filters. Candidate pairs
// are those of an independent sweep.
#include "tests/support/on_device.h"
#include "tests/support/long_form.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"
#include "base/error.h"

namespace tandem {
namespace {

using namespace support;

/// Powers of two and their neighbours, and four sizes between any two, up to `most`; ascending.
std::vector<std::uint32_t> rungs(std::uint32_t most) {
    std::set<std::uint32_t> sizes{1, most};
    for (std::uint32_t power = 1; power <= most; power *= 2) {
        for (const std::uint32_t near : {power - 1, power, power + 1}) sizes.insert(near);
        for (const double factor : {1.15, 1.32, 1.52, 1.74})
            sizes.insert(static_cast<std::uint32_t>(std::lround(power * factor)));
    }
    std::erase_if(sizes, [most](std::uint32_t size) { return size == 0 || size > most; });
    return {sizes.begin(), sizes.end()};
}

/// The first `count` tetrahedra of a box, folded along x = 0, so that its halves meet each other.
Mesh folded_part(std::uint32_t count) {
    std::uint32_t cells = 1;
    while (6 * cells * cells * cells < count) ++cells;
    Random random(count);
    auto mesh = shaken_box(cells, random);
    mesh.tetrahedra.resize(count);
    for (auto& v : mesh.vertices) v.x() = std::abs(v.x()) + 0.05 * v.y();
    complete_mesh(mesh, "part of a box");
    return mesh;
}

/// `bodies` bodies of `count` tetrahedra each in a cubic lattice, each overlapping its neighbours. The first
/// is fixed if there are more than two, every fifth is deformable. They turn and move from frame to frame.
/// `filtered`: each body meets no body whose number is equal modulo three, and not itself if it is even.
Scene lattice(std::uint32_t bodies, std::uint32_t count, bool filtered) {
    Scene scene;
    scene.name = scene.key = "lattice";
    scene.meshes = {folded_part(count)};
    for (std::uint32_t body = 0; body < bodies; ++body) {
        scene.bodies.push_back({.fixed = bodies > 2 && body == 0, .deformable = body % 5 == 4});
        if (!filtered) continue;
        scene.bodies.back().groups = 1u << body % 3;
        scene.bodies.back().meets = 7u & ~(1u << body % 3);
        if (body % 2 == 1) scene.bodies.back().meets = 7u;
    }
    scene.frame_count = 2;
    scene.frame = [bodies, rest = scene.meshes.front().vertices, all = scene.bodies](std::size_t index) {
        const auto side = static_cast<std::uint32_t>(std::ceil(std::cbrt(bodies)));
        Frame frame;
        frame.poses.resize(bodies);
        frame.deformed.resize(bodies);
        for (std::uint32_t body = 0; body < bodies; ++body) {
            const double moved = all[body].fixed ? 0 : 0.02 * static_cast<double>(index);
            const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.4 * body + moved, Eigen::Vector3d::UnitZ()));
            const Eigen::Vector3d at(0.8 * (body % side) + moved, 0.7 * (body / side % side),
                                     0.7 * (body / side / side));
            if (!all[body].deformable) {
                frame.poses[body] = {turn, at};
                continue;
            }
            for (const auto& vertex : rest) frame.deformed[body].push_back(turn * vertex + at);
        }
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// One way to run a preset.
struct Mode {
    std::string self, motion;
    bool filtered = false;
};

const std::vector<Mode> modes{{"off", "none"},  {"on", "none"},       {"off", "linear"},
                              {"on", "linear"}, {"on", "none", true}, {"off", "none", true}};

class Ladder : public OnDevice {
protected:
    /// Whether to run a preset: number of the algorithm, of the preset in it, and of the preset in all.
    using Chosen = std::function<bool(std::size_t algorithm, std::size_t preset, std::size_t number)>;
    void expect_right(const Scene& scene, const Mode& mode, const Chosen& chosen);

    std::uint64_t cells = 0, frames = 0, pairs = 0;
    std::set<std::string> refused; ///< presets and modes that exclude each other, with the reason

private:
    void expect_right(const Traversal& traversal, const Preset& preset, const Scene& scene, const Mode& mode);
    const ReferenceAnswer& right_for(const Session& session, const Scene& scene, const FrameInput& input);

    /// Those of the current scene and frame: the presets share few geometries.
    std::vector<std::tuple<Geometry, ContactSettings, ReferenceAnswer>> known_;
};

const ReferenceAnswer& Ladder::right_for(const Session& session, const Scene& scene,
                                         const FrameInput& input) {
    const auto geometry = geometry_of(session.settings());
    const auto settings = contact_settings_of(session.settings());
    for (const auto& [with_geometry, with_settings, right] : known_)
        if (with_geometry == geometry && with_settings == settings) return right;
    return std::get<2>(known_.emplace_back(
        geometry, settings, reference(scene, input, geometry, false, Method::sweep, settings)));
}

void Ladder::expect_right(const Traversal& traversal, const Preset& preset, const Scene& scene,
                          const Mode& mode) {
    auto given = preset.texts();
    given["self"] = mode.self;
    given["motion"] = mode.motion;
    given["contact_rule"] = "none";
    given["work_items"] = "256"; // more, and larger queues, would only cost time
    if (declares(traversal, "queue_capacity")) given["queue_capacity"] = "4096";
    const auto name =
        fmt::format("{} {} self={} motion={}", traversal.name(), preset.name, mode.self, mode.motion);
    std::unique_ptr<Session> session;
    try {
        session = prepare_on(on, traversal, scene, given);
    } catch (const InputError& error) {
        refused.insert(fmt::format("{}: {}", name, error.what()));
        return;
    }
    const auto frame = scene.frame(0);
    const auto next = scene.frame(1);
    const FrameInput input(frame, mode.motion == "linear" ? &next : nullptr);
    const auto& right = right_for(*session, scene, input);
    const auto result = session->run(input);
    EXPECT_EQ(result.count, right.digest.count) << name;
    EXPECT_EQ(result.digest(), right.digest) << name;
    ++cells;
    pairs += result.count;
}

void Ladder::expect_right(const Scene& scene, const Mode& mode, const Chosen& chosen) {
    SCOPED_TRACE(fmt::format("{} bodies of {} tetrahedra, self={} motion={} filtered={}", scene.bodies.size(),
                             scene.meshes.front().tetrahedra.size(), mode.self, mode.motion, mode.filtered));
    known_.clear();
    ++frames;
    std::size_t number = 0;
    for (std::size_t i = 0; i < algorithms().size(); ++i) {
        const auto presets = algorithms()[i]->presets();
        for (std::size_t j = 0; j < presets.size(); ++j, ++number)
            if (chosen(i, j, number)) expect_right(*algorithms()[i], presets[j], scene, mode);
    }
}

/// In short form every second size has pairs of one body, by the first preset of every second algorithm, and
/// the others a mode and a sixth of all presets in turn. Devices other than the host have a twelfth of the
/// sizes.
TEST_P(Ladder, EverySizeHasThePairsOfASweepLong) {
    struct Step {
        std::uint32_t bodies, count;
    };
    std::vector<Step> steps;
    for (const auto count : rungs(20000)) steps.push_back({2, count});
    for (const auto bodies : rungs(long_form() ? 3000 : 400))
        steps.push_back({bodies, bodies % 4 == 0 ? 40u : 6u});
    const std::size_t every = long_form() || GetParam() == "host" ? 1 : 12;
    for (std::size_t i = 0, turn = 0; i < steps.size(); i += every, ++turn)
        for (std::size_t mode = 0; mode < modes.size(); ++mode) {
            const bool is_self = turn % 2 == 0;
            if (!long_form() && mode != (is_self ? 1 : turn / 2 % modes.size())) continue;
            const auto [bodies, count] = steps[i];
            const auto chosen = [&](std::size_t algorithm, std::size_t preset, std::size_t number) {
                if (long_form()) return true;
                return is_self ? preset == 0 && algorithm % 2 == turn / 2 % 2 : number % 6 == turn / 2 % 6;
            };
            expect_right(lattice(bodies, count, modes[mode].filtered), modes[mode], chosen);
            if (HasFailure()) return;
        }
    EXPECT_GT(pairs, 100000u);
    fmt::print("{} sizes, {} frames, {} cells, {} pairs on {}; refused:\n", steps.size(), frames, cells,
               pairs, GetParam());
    for (const auto& reason : refused) {
        fmt::print("  {}\n", reason);
        EXPECT_THAT(reason, testing::HasSubstr("motion=linear does not go with residency=published"));
    }
}

TANDEM_ON_DEVICES(Ladder);

} // namespace
} // namespace tandem
