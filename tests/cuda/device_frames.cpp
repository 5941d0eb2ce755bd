// SPDX-License-Identifier: MIT
// Frames in an application's GPU memory, on the stub of the driver: kernels receive the application's
// addresses, nothing is copied, and such frames are submitted as graphs. The device follows other streams or
// works on one.
#include "tests/cuda/stubbed.h"
#include "tests/support/cells.h"
#include "tests/support/message_of.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"
#include "tests/unit/backends/device_support.h"

namespace tandem {
namespace {

using namespace support;

class CudaFrames : public CudaDevice {
protected:
    using Numbers = std::vector<double>;

    std::unique_ptr<Session> prepare(Device& on) {
        const std::array devices{&on};
        const auto& tiled = algorithm("tiled");
        return tiled.prepare(devices, scene, resolve(tiled.parameters(), {}, {}, "tiled"));
    }
    /// A frame in the application's memory.
    DeviceFrame frame(Device& on, Numbers& pose_rows, Numbers& vertex_rows) {
        DeviceFrame frame{{on.adopt(pose_rows.data(), pose_rows.size() * 8, "poses"), Precision::fp64},
                          std::vector<DeviceRows>(scene.bodies.size())};
        frame.deformed[1] = {on.adopt(vertex_rows.data(), vertex_rows.size() * 8, "vertices"),
                             Precision::fp64};
        return frame;
    }
    static unsigned long launches_with(const void* address) { return ask("stub_launches_with", address); }
    static unsigned long copies_of(const void* address) { return ask("stub_copies_of", address); }
    static unsigned long ask(const char* name, const void* address) {
        return entry_of_stub<unsigned long(unsigned long long)>(name)(
            reinterpret_cast<unsigned long long>(address));
    }
    CUstream_st* stream_of(Context context) {
        make_current(context);
        CUstream_st* stream = nullptr;
        entry<CUstream_st**, unsigned>("cuStreamCreate")(&stream, 0);
        make_current(nullptr);
        return stream;
    }
    static unsigned long calls(CUstream_st* stream, Context context) {
        return entry_of_stub<unsigned long(CUstream_st*, Context)>("stub_calls")(stream, context);
    }
    static Context primary() {
        Context context = nullptr;
        entry<Context*, int>("cuDevicePrimaryCtxRetain")(&context, 0);
        return context;
    }

    Scene scene = crowd(81, 6, 0.9);
    Numbers poses = Numbers(6 * 7, 0.5), vertices = Numbers(3 * scene.meshes[1].vertices.size(), 0.5);
};

/// Counters per address continue from earlier tests, so differences are compared.
TEST_F(CudaFrames, KernelsReadTheApplicationsOwnMemory) {
    const auto session = prepare(*device);
    const auto given = frame(*device, poses, vertices);
    EXPECT_EQ(given.poses.buffer.native(), poses.data());
    const auto packed = launches_with(poses.data()), packed_vertices = launches_with(vertices.data());
    const auto copies = copies_of(poses.data()) + copies_of(vertices.data());
    for (unsigned long i = 1; i < 3; ++i) {
        session->run(given);
        EXPECT_EQ(launches_with(poses.data()), packed + i) << "one launch packs all poses";
        EXPECT_EQ(launches_with(vertices.data()), packed_vertices + i);
    }
    EXPECT_EQ(copies_of(poses.data()) + copies_of(vertices.data()), copies);
}

TEST_F(CudaFrames, AreGraphsFromTheThirdTimeOn) {
    const auto session = prepare(*device);
    const auto given = frame(*device, poses, vertices);
    const auto submissions = [&](const DeviceFrame& of) {
        const auto before = device->submissions();
        session->run(of);
        return device->submissions() - before;
    };
    EXPECT_GT(submissions(given), 7u) << "sorts bodies";
    EXPECT_GT(submissions(given), 7u) << "is not a graph yet";
    for (int i = 0; i < 3; ++i) EXPECT_EQ(submissions(given), 1u);
    Numbers other_poses(poses);
    const auto before = launches_with(other_poses.data());
    const auto other_frame = frame(*device, other_poses, vertices);
    EXPECT_GT(submissions(other_frame), 7u);
    EXPECT_EQ(submissions(other_frame), 1u);
    EXPECT_EQ(submissions(given), 1u);
    EXPECT_EQ(launches_with(other_poses.data()), before + 2) << "at once, and when the graph was captured";
}

TEST_F(CudaFrames, WorkOnTheApplicationsStream) {
    auto* const stream = stream_of(primary());
    auto on = cuda::on_stream(0, stream);
    EXPECT_EQ(on->info().id, "cuda:0");
    EXPECT_EQ(on->queue(), stream);
    const auto before = calls(stream, primary());
    {
        const auto session = prepare(*on);
        session->run(frame(*on, poses, vertices));
    }
    EXPECT_GT(calls(stream, primary()), before + 7);
    on.reset(); // the stream still belongs to the application
    make_current(primary());
    EXPECT_EQ(entry<CUstream_st*>("cuStreamSynchronize")(stream), 0);
    entry<CUstream_st*>("cuStreamDestroy_v2")(stream);
    make_current(nullptr);
    EXPECT_EQ(cuda::on_stream(0, nullptr)->queue(), nullptr);
    EXPECT_EQ(cuda::on_stream(0, reinterpret_cast<void*>(1))->queue(), nullptr) << "CU_STREAM_LEGACY";
    EXPECT_THAT(unit_test::message_of([] { cuda::on_stream(3, nullptr); }),
                testing::HasSubstr("cuda:3: the driver has 1 devices, numbered from 0"));
}

/// The application captures a stream of its own, and the device's stream joins it.
class CapturedFrames : public CudaFrames {
protected:
    /// The error of `work`, and the graph of what it enqueued.
    template<class Work>
    std::pair<std::string, void*> captured(const Work& work) {
        make_current(primary());
        EXPECT_EQ((entry<CUstream_st*, int>("cuStreamBeginCapture_v2")(stream, 0)), 0);
        device->follow(stream);
        const auto message = support::message_of(work);
        device->precede(stream);
        void* graph = nullptr;
        EXPECT_EQ((entry<CUstream_st*, void**>("cuStreamEndCapture")(stream, &graph)), 0);
        make_current(nullptr);
        return {message, graph};
    }

    CUstream_st* stream = stream_of(primary());
};

TEST_F(CapturedFrames, AreCommandsOfTheApplicationsGraph) {
    const auto session = prepare(*device);
    const auto given = frame(*device, poses, vertices);
    const auto enqueue = [&] { session->enqueue(given); };
    for (int i = 0; i < 3; ++i) enqueue(); // prepares; its own graph is then known
    const auto waits = entry_of_stub<unsigned long()>("stub_waits");
    const auto launches = entry_of_stub<unsigned long()>("stub_graph_launches");
    const auto waited = waits(), launched = launches();
    enqueue();
    EXPECT_EQ(launches(), launched + 1) << "one submission";
    const auto [message, graph] = captured(enqueue);
    EXPECT_EQ(message, "no error");
    EXPECT_EQ(waits(), waited);
    EXPECT_EQ(launches(), launched + 1) << "no graph within a graph";
    void* executable = nullptr;
    make_current(primary());
    entry<void**, void*, unsigned long long>("cuGraphInstantiateWithFlags")(&executable, graph, 0);
    const auto packed = launches_with(poses.data());
    const auto commands = entry_of_stub<unsigned long()>("stub_commands_in_graphs");
    const auto before = commands();
    entry<void*, CUstream_st*>("cuGraphLaunch")(executable, stream);
    EXPECT_GT(commands(), before) << "the graph has the frame's commands";
    EXPECT_EQ(launches_with(poses.data()), packed);
    entry<void*>("cuGraphExecDestroy")(executable);
    make_current(nullptr);
}

TEST_F(CapturedFrames, NeedAPreparedFrameOfTheirKindInDeviceMemory) {
    const auto session = prepare(*device);
    const auto given = frame(*device, poses, vertices);
    const auto is_refused = [&] {
        EXPECT_THAT(captured([&] { session->enqueue(given); }).first,
                    testing::HasSubstr("enqueue a frame before the capture"));
    };
    is_refused();
    session->enqueue(scene.frame(0)); // a frame of another kind does not prepare it
    is_refused();
    session->enqueue(given, all_pairs(scene));
    is_refused();
    EXPECT_THAT(captured([&] { session->enqueue(scene.frame(0)); }).first,
                testing::HasSubstr("the host's memory, which the graph would not read again"));
    EXPECT_THAT(captured([&] { session->enqueue(given, all_pairs(scene)); }).first,
                testing::HasSubstr("the host's memory, which the graph would not read again"));
}

TEST_F(CudaFrames, FollowOtherStreamsAndPrecedeThem) {
    const auto waits = entry_of_stub<unsigned long()>("stub_waits");
    const auto orderings = entry_of_stub<unsigned long(CUstream_st*, CUstream_st*)>("stub_orderings");
    auto* const own = static_cast<CUstream_st*>(device->queue());
    auto* const legacy = reinterpret_cast<CUstream_st*>(1);
    const auto waited = waits();
    for (auto* const stream : {stream_of(primary()), stream_of(primary()), legacy, own}) {
        auto* const named = stream == legacy ? nullptr : stream;
        const auto before = orderings(own, named);
        device->follow(stream);
        EXPECT_EQ(orderings(own, named), before + (stream != own));
        const auto after = orderings(named, own);
        device->precede(stream);
        EXPECT_EQ(orderings(named, own), after + (stream != own));
        EXPECT_EQ(current(), nullptr);
    }
    EXPECT_EQ(waits(), waited) << "the host does not wait";
}

} // namespace
} // namespace tandem
