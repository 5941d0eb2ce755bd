// SPDX-License-Identifier: MIT
// Commands submitted as graphs, on the stub of the driver: which commands, equal effects, and the submissions
// of sessions.
#include "tests/cuda/allocations.h"
#include "tests/cuda/stubbed.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"
#include "tests/unit/backends/device_support.h"

namespace tandem {
namespace {

using namespace support;

/// Frames with the same commands, submitted as a graph from the second time on. A frame uploads words and
/// reads them back.
class CudaGraphs : public CudaDevice {
protected:
    /// A frame of five commands and one wait; returns the words that it read back.
    std::vector<std::uint32_t> frame(std::uint32_t value, std::uint32_t argument = 7) {
        std::vector<std::uint32_t> values(16, value), back(16);
        const auto work = [&] {
            device->upload(words, bytes_of(values));
            device->clear(words, 32);
            const std::array<Argument, 2> arguments{words, argument};
            device->launch(kernel, {2, 1}, arguments);
            device->launch(kernel, {4, 1}, arguments);
            device->download(words, std::as_writable_bytes(std::span(back)));
        };
        device->as_one(work);
        return back;
    }
    static std::vector<std::uint32_t> answer(std::uint32_t value) {
        std::vector<std::uint32_t> expected(16, value);
        std::fill_n(expected.begin(), 8, 0u);
        return expected;
    }
    void SetUp() override {
        CudaDevice::SetUp();
        words = device->allocate(64, "words");
        kernel = unit_test::compile(*device, "do_nothing");
    }
    ~CudaGraphs() override {
        unsetenv("STUB_GRAPH");
        unsetenv("STUB_INSTANTIATE");
        words = {};
        device.reset();
        EXPECT_EQ(graphs(), 0u) << "destroyed with the device";
    }
    static unsigned long graphs() { return entry_of_stub<unsigned long()>("stub_graphs")(); }
    static unsigned long launches() { return entry_of_stub<unsigned long()>("stub_graph_launches")(); }
    static unsigned long commands() { return entry_of_stub<unsigned long()>("stub_commands_in_graphs")(); }

    Buffer words;
    Kernel kernel;
};

TEST_F(CudaGraphs, TheSameCommandsAreAGraphFromTheSecondTimeOn) {
    const StageScope stage(*device, Stage::traverse);
    const auto launched = launches(), in_graphs = commands();
    auto submitted = device->submissions();
    EXPECT_EQ(frame(1), answer(1));
    EXPECT_EQ(graphs(), 0u);
    EXPECT_EQ(device->submissions(), submitted + 5);
    submitted = device->submissions();
    for (std::uint32_t value = 2; value < 10; ++value) EXPECT_EQ(frame(value), answer(value));
    EXPECT_EQ(graphs(), 1u);
    EXPECT_EQ(launches(), launched + 8);
    EXPECT_EQ(commands(), in_graphs + 8 * 5);
    EXPECT_EQ(device->submissions(), submitted + 8);
    const auto before = allocations();
    for (std::uint32_t value = 0; value < 100; ++value) {
        const auto back = frame(value); // the test itself allocates two vectors a frame
    }
    EXPECT_EQ(allocations(), before + 200);
}

TEST_F(CudaGraphs, OtherArgumentsBuffersAndGridsAreOtherCommands) {
    const StageScope stage(*device, Stage::traverse);
    for (int i = 0; i < 2; ++i) frame(1);
    ASSERT_EQ(graphs(), 1u);
    const auto launched = launches();
    EXPECT_EQ(frame(2, 8), answer(2));
    EXPECT_EQ(launches(), launched);
    EXPECT_EQ(frame(3, 8), answer(3));
    EXPECT_EQ(launches(), launched + 1);
    EXPECT_EQ(frame(4, 7), answer(4)); // the first is remembered
    EXPECT_EQ(launches(), launched + 2);
    EXPECT_EQ(graphs(), 2u);
    const auto kept = std::exchange(words, device->allocate(64, "others"));
    EXPECT_EQ(frame(5), answer(5));
    EXPECT_EQ(launches(), launched + 2);
    for (std::uint32_t argument = 100; argument < 150; ++argument)
        for (int i = 0; i < 3; ++i) EXPECT_EQ(frame(argument, argument), answer(argument));
    EXPECT_LE(graphs(), 16u);
}

/// A graph with a large upload would make the device wait for the host.
TEST_F(CudaGraphs, ALargeUploadAndLaterCommandsAreSubmittedAtOnce) {
    const StageScope stage(*device, Stage::traverse);
    const auto large = device->allocate(100000, "large");
    for (std::size_t bytes : {100000u, 65537u, 65536u})
        for (int i = 0; i < 3; ++i) {
            const auto before = device->submissions(), launched = launches();
            std::vector<std::byte> zeros(bytes), back(1);
            device->as_one([&] {
                device->clear(large, 16);
                device->upload(large, zeros);
                device->clear(large, 16);
                device->download(large, back);
            });
            const bool one = bytes == 65536 && i > 0;
            EXPECT_EQ(device->submissions() - before, one ? 1u : 4u);
            EXPECT_EQ(launches() - launched, one ? 1u : 0u);
        }
}

/// The same commands with other memory at the buffer's address would look equal.
TEST_F(CudaGraphs, NoGraphOutlivesABufferOfItsCommands) {
    const StageScope stage(*device, Stage::traverse);
    for (int i = 0; i < 3; ++i) frame(1);
    ASSERT_EQ(graphs(), 1u);
    const auto launched = launches();
    { const auto gone = device->allocate(64, "gone"); }
    EXPECT_EQ(frame(2), answer(2));
    EXPECT_EQ(graphs(), 0u);
    EXPECT_EQ(launches(), launched);
    EXPECT_EQ(frame(3), answer(3));
    EXPECT_EQ(frame(4), answer(4));
    EXPECT_EQ(graphs(), 1u);
    EXPECT_EQ(launches(), launched + 2);
}

TEST_F(CudaGraphs, ClocksAndTheDefaultStreamSubmitCommandsOneByOne) {
    {
        const StageScope stage(*device, Stage::traverse); // ends before its device
        device->set_clocks(Clocks::on);
        for (int i = 0; i < 3; ++i) frame(1);
        EXPECT_EQ(device->finish().events.size(), 15u);
        device->set_clocks(Clocks::off);
    }
    EXPECT_EQ(graphs(), 0u);
    words = {};
    make_current(other);
    device = cuda::adopt(other, nullptr);
    {
        const StageScope adopted(*device, Stage::traverse);
        words = device->allocate(64, "words");
        kernel = unit_test::compile(*device, "do_nothing");
        for (std::uint32_t value = 0; value < 3; ++value) EXPECT_EQ(frame(value), answer(value));
    }
    EXPECT_EQ(graphs(), 0u);
    words = {};
    kernel = {};
    make_current(nullptr);
}

TEST_F(CudaGraphs, CommandsEnqueuedBeforeAnExceptionRun) {
    const StageScope stage(*device, Stage::traverse);
    std::vector<std::uint32_t> back(16);
    EXPECT_THROW(device->as_one([&] {
        device->upload(words, bytes_of(std::vector<std::uint32_t>(16, 5)));
        throw std::runtime_error("no more");
    }),
                 std::runtime_error);
    device->download(words, std::as_writable_bytes(std::span(back)));
    EXPECT_EQ(back, std::vector<std::uint32_t>(16, 5));
}

/// A buffer may be freed, and another allocated, before the commands on it are submitted.
TEST_F(CudaGraphs, ABufferLivesUntilItsCommandsAreSubmitted) {
    const StageScope stage(*device, Stage::traverse);
    for (int i = 0; i < 3; ++i)
        device->as_one([&] {
            auto short_lived = device->allocate(64, "short");
            device->clear(short_lived, 64);
            short_lived = {};
            const auto next = device->allocate(64, "next");
            device->clear(next, 64);
        });
    EXPECT_EQ(device->bytes_allocated(), 64u);
}

TEST_F(CudaGraphs, ErrorsNameTheirOperation) {
    const StageScope stage(*device, Stage::traverse);
    frame(1);
    setenv("STUB_INSTANTIATE", "700", 1);
    EXPECT_THAT(
        unit_test::message_of([&] { frame(2); }),
        testing::AllOf(testing::HasSubstr("cuGraphInstantiate failed with CUDA_ERROR_ILLEGAL_ADDRESS"),
                       testing::HasSubstr("while capturing 5 commands")));
    unsetenv("STUB_INSTANTIATE");
    EXPECT_EQ(frame(3), answer(3));
    setenv("STUB_GRAPH", "2", 1);
    EXPECT_THROW(frame(4), OutOfMemory);
    setenv("STUB_GRAPH", "700", 1);
    EXPECT_THAT(unit_test::message_of([&] { frame(4); }),
                testing::AllOf(testing::HasSubstr("cuGraphLaunch failed with CUDA_ERROR_ILLEGAL_ADDRESS"),
                               testing::HasSubstr("while submitting 5 commands as one")));
    unsetenv("STUB_GRAPH");
    EXPECT_EQ(frame(5), answer(5));
    setenv("STUB_LAUNCH", "700", 1);
    EXPECT_THAT(unit_test::message_of([&] { frame(6, 9); }),
                testing::HasSubstr("while launching 'do_nothing' with 2 groups of 1"));
    EXPECT_THAT(unit_test::message_of([&] { frame(6, 9); }), // while capturing
                testing::HasSubstr("while launching 'do_nothing' with 2 groups of 1"));
    unsetenv("STUB_LAUNCH");
    EXPECT_EQ(frame(7, 9), answer(7));
}

/// Kernels of the stub find no pairs; the test counts submissions of a session.
class CudaSessions : public CudaGraphs {
protected:
    /// Number of submissions in each of five frames.
    std::vector<std::uint64_t> calls(Session& session) {
        std::vector<std::uint64_t> counts;
        for (std::size_t i = 0; i < 5; ++i) {
            const auto before = device->submissions(), waited = waits();
            EXPECT_EQ(session.run(scene.frame(i % 2)).count, 0u);
            counts.push_back(device->submissions() - before);
            waits_of_last = waits() - waited;
        }
        return counts;
    }
    std::unique_ptr<Session> prepare(const Traversal& traversal, const SettingTexts& given) {
        const std::array devices{device.get()};
        return traversal.prepare(devices, scene,
                                 resolve(traversal.parameters(), {}, given, traversal.name()));
    }

    static unsigned long waits() { return entry_of_stub<unsigned long()>("stub_waits")(); }

    Scene scene = crowd(81, 6, 0.9);
    unsigned long waits_of_last = 0; ///< waits in the last frame of calls()
};

/// A tree over all bodies is built every other frame, by the same commands as in the frames that keep it.
TEST_F(CudaSessions, AFrameThatBuildsATreeIsOneSubmission) {
    const auto one =
        calls(*prepare(algorithm("leaf_query"), {{"broad", "device"}, {"tree", "scene"}, {"rebuild", "2"}}));
    const auto each =
        calls(*prepare(algorithm("leaf_query"),
                       {{"broad", "device"}, {"tree", "scene"}, {"rebuild", "2"}, {"submission", "each"}}));
    EXPECT_GT(each[1], 20u);
    EXPECT_EQ(one, (std::vector<std::uint64_t>{each[0], each[1], 1, 1, 1}));
}

TEST_F(CudaSessions, AFrameIsOneSubmissionForEachWait) {
    for (const auto* traversal : algorithms()) {
        SCOPED_TRACE(traversal->name());
        const auto each = calls(*prepare(*traversal, {{"broad", "device"}, {"submission", "each"}}));
        EXPECT_GT(each[1], 7u);
        EXPECT_EQ(each[1], each[4]);
        // The first frame also sorts bodies and refits fixed ones; the second is not yet known.
        const auto one = calls(*prepare(*traversal, {{"broad", "device"}}));
        const auto waited = waits_of_last;
        EXPECT_EQ(waited, traversal->name() == "gproximity" ? 2u : 1u);
        EXPECT_EQ(one, (std::vector<std::uint64_t>{each[0], each[1], waited, waited, waited}));
        // The host finds body pairs while the device refits.
        const auto host = calls(*prepare(*traversal, {{"broad", "sphere"}}));
        EXPECT_GT(host[4], 7u);
    }
}

/// The effects of a failed frame are unknown: the next one uploads everything, including constant poses.
TEST_F(CudaSessions, AFrameAfterAnErrorUploadsFixedBodies) {
    for (auto& body : scene.bodies) body.fixed = !body.deformable;
    const auto session = prepare(algorithm("tiled"), {{"broad", "device"}, {"submission", "each"}});
    calls(*session);
    const auto usual = calls(*session);
    EXPECT_EQ(usual, std::vector<std::uint64_t>(5, usual[0]));
    setenv("STUB_LAUNCH", "700", 1);
    EXPECT_THROW(session->run(scene.frame(0)), DeviceError);
    unsetenv("STUB_LAUNCH");
    auto after = usual;
    ++after[0];
    EXPECT_EQ(calls(*session), after);
}

} // namespace
} // namespace tandem
