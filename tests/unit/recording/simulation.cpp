// SPDX-License-Identifier: MIT
#include "scenes/recording/recording.h"
#include "scenes/recording/writer.h"
#include "tests/support/folder.h"
#include "tests/unit/simulate/support.h"

namespace tandem {
namespace {

using namespace support;

/// A box and a soft beam that fall on a fixed plate.
unit_test::World falling() {
    unit_test::World world({0.4, 0.3});
    world.dynamics.stepping.step = 0.004;
    world.dynamics.solver.warm_start = true;
    world.add(unit_test::box({6, 1, 6}), unit_test::at(0, -0.5, 0), true);
    world.add(unit_test::box({1, 1, 1}), unit_test::at(0, 0.51, 0));
    Elastic elastic;
    elastic.young = 2e5;
    elastic.poisson = 0.3;
    auto mesh = unit_test::beam({1, 0.5, 0.5}, {2, 1, 1});
    for (auto& v : mesh.vertices) v += Eigen::Vector3d(1, 0.01, 0);
    world.add_soft(std::move(mesh), elastic);
    return world;
}

/// The loop of writer.h, up to `steps` steps with a checkpoint after every tenth; no checkpoint at the end.
std::vector<std::byte> simulate(const std::string& file, const Scene& scene, bool resume, std::size_t steps) {
    const auto header = recording_of("falling.json", scene, scene.dynamics->stepping.step);
    const auto detect = unit_test::detector(scene);
    Simulation simulation(scene);
    auto writer = resume ? RecordingWriter::resume(file, header) : RecordingWriter::create(file, header);
    if (const auto checkpoint = writer.restore())
        simulation.restore(checkpoint->state);
    else
        writer.checkpoint(0, simulation.state());
    while (simulation.steps_done() < steps) {
        const auto report = simulation.step(detect);
        writer.append(report.step, report.midway_time(), simulation.midway());
        if (simulation.steps_done() % 10 == 0) writer.checkpoint(simulation.steps_done(), simulation.state());
    }
    return simulation.state();
}

class RecordingSimulation : public FolderTest {};

TEST_F(RecordingSimulation, AResumedRunHasTheBytesOfAnUninterruptedRun) {
    auto world = falling();
    const auto& scene = world.finish();
    const auto end = simulate(path("whole.frames"), scene, false, 40);
    simulate(path("parts.frames"), scene, false, 7);
    for (const std::size_t steps : {18, 20, 33}) simulate(path("parts.frames"), scene, true, steps);
    EXPECT_EQ(Recording(path("parts.frames")).frames(), 33u);
    EXPECT_EQ(simulate(path("parts.frames"), scene, true, 40), end);
    EXPECT_TRUE(bytes_of(path("parts.frames")) == bytes_of(path("whole.frames")));
    const Recording recording(path("whole.frames"));
    const auto first = recording.read(0, scene.frame(0).poses),
               last = recording.read(39, scene.frame(0).poses);
    EXPECT_EQ(last.step, 39u);
    EXPECT_NEAR(first.time, 0.002, 1e-12); // the middle of a step of 4 ms
    EXPECT_NEAR(last.time, 39 * 0.004 + 0.002, 1e-12);
    EXPECT_NE(last.frame.poses[1].translation, first.frame.poses[1].translation);
    EXPECT_NE(last.frame.deformed[2], first.frame.deformed[2]);
    EXPECT_EQ(last.frame.poses[0].translation, scene.frame(0).poses[0].translation);
}

} // namespace
} // namespace tandem
