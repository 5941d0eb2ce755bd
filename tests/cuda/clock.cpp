// SPDX-License-Identifier: MIT
// Timing of CUDA commands, on stubs of the driver and of CUPTI. A failure of CUPTI affects the whole process,
// so the tests of failures run in separate processes.
#include "tests/cuda/stub_cupti.h"
#include "tests/cuda/stubbed.h"
#include "tests/support/test.h"
#include "tests/unit/backends/device_support.h"

namespace tandem {
namespace {

using testing::ElementsAre;
using Times = std::vector<std::pair<std::int64_t, std::int64_t>>; ///< begin and duration

template<class Function>
Function* entry_of_cupti(const char* name) {
    static auto* const library = dlopen(std::getenv("TANDEM_CUPTI"), RTLD_NOW);
    return reinterpret_cast<Function*>(dlsym(library, name));
}

unsigned long cupti_calls() { return entry_of_cupti<unsigned long()>("stub_cupti_calls")(); }
unsigned long cupti_enabled() { return entry_of_cupti<unsigned long()>("stub_cupti_enabled")(); }
bool cupti_attached() { return entry_of_cupti<bool()>("stub_cupti_attached")(); }
unsigned long event_records() { return entry_of_stub<unsigned long()>("stub_event_records")(); }

/// Sets an environment variable of the stubs for a scope.
class Set {
public:
    Set(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
    ~Set() { unsetenv(name_); }
    Set(const Set&) = delete;
    Set& operator=(const Set&) = delete;

private:
    const char* name_;
};

/// Commands for a device, and their times.
struct Work {
    explicit Work(Device& on)
        : device(on),
          stage(on, Stage::traverse),
          words(on.allocate(64, "words")),
          kernel(unit_test::compile(on, "do_nothing")) {}

    void launch() { device.launch(kernel, {2, 1}, std::array<Argument, 1>{words}); }
    void clear() { device.clear(words, 32); }
    void upload() { device.upload(words, bytes_of(values)); }
    void download() { device.download(words, std::as_writable_bytes(std::span(values))); }
    /// Times of the commands since the last call.
    Times times() {
        Times found;
        for (const auto& event : device.finish().events)
            if (event.ticket != 0) found.emplace_back(event.begin_ns, event.device_ns);
        return found;
    }
    /// One command of each kind, two launches.
    Times all() {
        launch();
        clear();
        upload();
        launch();
        download();
        return times();
    }

    Device& device;
    StageScope stage;
    Buffer words;
    Kernel kernel;
    std::vector<std::uint32_t> values = std::vector<std::uint32_t>(16, 1);
};

/// Expected times of `count` consecutive commands, the first of which has number `first` in the stub.
Times expected(std::size_t count, std::int64_t first) {
    Times times;
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(count); ++i)
        times.emplace_back(1000 * i, 100 + first + i);
    return times;
}

class CuptiClock : public CudaDevice {
protected:
    /// The number of the next command.
    std::int64_t next() {
        Work work(*device);
        work.launch();
        return work.times().front().second - 100 + 1;
    }
};

TEST_F(CuptiClock, TimesComeFromTheRecords) {
    const auto before = event_records();
    device->set_clocks(Clocks::on);
    const auto first = next();
    Work work(*device);
    EXPECT_EQ(work.all(), expected(5, first));
    EXPECT_EQ(work.all(), expected(5, first + 5));
    EXPECT_EQ(work.times(), Times{});
    EXPECT_EQ(event_records(), before);
    EXPECT_EQ(device->clock(), "CUPTI 13.0 activity records");
    EXPECT_EQ(current(), nullptr);
    device->set_clocks(Clocks::off);
    EXPECT_EQ(device->clock(), "CUPTI 13.0 activity records");
}

TEST_F(CuptiClock, RecordsComeInAnyOrder) {
    const Set backwards("STUB_CUPTI_BACKWARDS", "1");
    device->set_clocks(Clocks::on);
    const auto first = next();
    EXPECT_EQ(Work(*device).all(), expected(5, first));
}

TEST_F(CuptiClock, ALostRecordIsUnknown) {
    device->set_clocks(Clocks::on);
    Work work(*device);
    const auto first = next();
    const Set second("STUB_CUPTI_LOSES", std::to_string(first + 1));
    auto times = expected(5, first);
    times[1] = {-1, -1};
    EXPECT_EQ(work.all(), times);
    const Set the_first("STUB_CUPTI_LOSES", std::to_string(first + 5));
    times = expected(5, first + 5);
    times[0] = {-1, -1};
    for (std::size_t i = 1; i < times.size(); ++i) times[i].first -= 1000;
    EXPECT_EQ(work.all(), times) << "relative to the first known time";
    EXPECT_EQ(device->clock(), "CUPTI 13.0 activity records");
}

TEST_F(CuptiClock, IsAttachedOnlyWhileClocksAreOn) {
    const auto before = cupti_calls();
    EXPECT_EQ(device->clock(), "CUPTI activity records or CUDA events");
    Work work(*device);
    work.all();
    EXPECT_EQ(cupti_calls(), before);
    for (int i = 0; i < 2; ++i) {
        device->set_clocks(Clocks::on);
        EXPECT_TRUE(cupti_attached());
        EXPECT_EQ(cupti_enabled(), 5u);
        EXPECT_EQ(work.all().size(), 5u);
        device->set_clocks(Clocks::off);
        EXPECT_FALSE(cupti_attached());
        EXPECT_EQ(cupti_enabled(), 0u);
    }
    const auto after = cupti_calls();
    work.all();
    device->as_one([&] { work.clear(); });
    device->set_clocks(Clocks::off);
    EXPECT_EQ(cupti_calls(), after);
}

TEST_F(CuptiClock, EveryDeviceHasItsOwn) {
    CUstream_st* stream = nullptr;
    make_current(other);
    entry<CUstream_st**, unsigned>("cuStreamCreate")(&stream, 0);
    make_current(nullptr);
    auto adopted = cuda::adopt(other, stream);
    device->set_clocks(Clocks::on);
    adopted->set_clocks(Clocks::on);
    const auto first = next();
    {
        Work on_device(*device), on_adopted(*adopted);
        on_device.launch();
        on_adopted.clear();
        on_device.launch();
        on_adopted.launch();
        EXPECT_THAT(on_adopted.times(), ElementsAre(std::pair(0, 101 + first), std::pair(2000, 103 + first)));
        on_adopted.launch();
        EXPECT_THAT(on_device.times(), ElementsAre(std::pair(0, 100 + first), std::pair(2000, 102 + first)));
        EXPECT_THAT(on_adopted.times(), ElementsAre(std::pair(0, 104 + first)));
    }
    device->set_clocks(Clocks::off);
    EXPECT_TRUE(cupti_attached()) << "for the other device";
    adopted.reset();
    EXPECT_FALSE(cupti_attached()) << "the device ended with clocks on";
}

TEST_F(CuptiClock, AFailedCommandHasNoTime) {
    device->set_clocks(Clocks::on);
    const auto first = next();
    Work work(*device);
    work.launch();
    {
        const Set refuses("STUB_LAUNCH", "700");
        EXPECT_THROW(work.launch(), DeviceError);
    }
    work.clear();
    EXPECT_THAT(work.times(), ElementsAre(std::pair(0, 100 + first), std::pair(2000, 102 + first)));
    EXPECT_EQ(entry_of_cupti<unsigned long()>("stub_cupti_pushed")(), 0u);
    EXPECT_EQ(work.all(), expected(5, first + 3));
    device->set_clocks(Clocks::off);
}

/// The environment sets what CUPTI lacks and the expected description of the clock.
class NoCupti : public CudaDevice {};

TEST_F(NoCupti, ByEvents) {
    device->set_clocks(Clocks::on);
    EXPECT_EQ(device->clock(), std::getenv("EXPECTED_CLOCK"));
    Work work(*device);
    const auto before = event_records();
    EXPECT_EQ(work.all(), Times(5, {1000, 1000}));
    EXPECT_EQ(event_records(), before + 10);
    for (const auto clocks : {Clocks::off, Clocks::on}) device->set_clocks(clocks);
    EXPECT_EQ(work.all(), Times(5, {1000, 1000}));
    EXPECT_EQ(device->clock(), std::getenv("EXPECTED_CLOCK"));
}

class CuptiFails : public CudaDevice {};

/// CUPTI accepts every call but makes no records.
TEST_F(CuptiFails, MakesNoRecords) {
    const Set loses("STUB_CUPTI_LOSES", "all");
    device->set_clocks(Clocks::on);
    Work work(*device);
    EXPECT_EQ(work.all(), Times(5, {-1, -1}));
    EXPECT_EQ(device->clock(), "CUDA events (CUPTI: it made no records)");
    EXPECT_FALSE(cupti_attached());
    EXPECT_EQ(work.all(), Times(5, {1000, 1000}));
}

TEST_F(CuptiFails, WhileCommandsRun) {
    device->set_clocks(Clocks::on);
    Work work(*device);
    work.launch();
    {
        const Set fails("STUB_CUPTI_FAILS", "cuptiActivityPushExternalCorrelationId");
        work.clear();
    }
    work.launch();
    const auto times = work.times();
    ASSERT_EQ(times.size(), 3u);
    EXPECT_GT(times[0].second, 0);
    EXPECT_EQ(times[1], std::pair(std::int64_t{-1}, std::int64_t{-1}));
    EXPECT_EQ(times[2], std::pair(std::int64_t{-1}, std::int64_t{-1}));
    EXPECT_EQ(device->clock(), "CUDA events (CUPTI: cuptiActivityPushExternalCorrelationId failed with 35)");
    EXPECT_EQ(work.all(), Times(5, {1000, 1000}));
}

/// Another profiler may be attached, and stays attached.
TEST_F(CuptiFails, AnotherToolHasIt) {
    char* subscriber = nullptr;
    entry_of_cupti<int(char**, void (*)(), void*)>("cuptiSubscribe")(&subscriber, nullptr, nullptr);
    device->set_clocks(Clocks::on);
    EXPECT_EQ(device->clock(), "CUDA events (CUPTI: cuptiSubscribe failed with 39)");
    EXPECT_EQ(Work(*device).all(), Times(5, {1000, 1000}));
    device->set_clocks(Clocks::off);
    EXPECT_TRUE(cupti_attached());
}

} // namespace
} // namespace tandem
