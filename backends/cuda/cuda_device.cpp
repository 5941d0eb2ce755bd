// SPDX-License-Identifier: MIT
#include "backends/cuda/cuda_device.h"

#include "backends/cuda/call_error.h"
#include "backends/cuda/command.h"
#include "backends/cuda/command_clock.h"
#include "backends/cuda/current_context.h"
#include "backends/cuda/description.h"
#include "backends/cuda/graphs.h"
#include "backends/cuda/primary_context.h"
#include "backends/ptxas_log.h"
#include "backends/staging.h"

#include <array>
#include <fmt/format.h>
#include <type_traits>

namespace tandem::cuda {

namespace {

struct CudaBuffer : Buffer::Impl {
    const Driver* driver = nullptr;
    Context context = nullptr;
    DevicePointer pointer = 0;
    bool owned = true;
    std::shared_ptr<std::uint64_t> frees; ///< the device's count of freed buffers
    CudaBuffer() = default;
    CudaBuffer(const CudaBuffer&) = delete;
    CudaBuffer& operator=(const CudaBuffer&) = delete;
    ~CudaBuffer() override {
        if (frees) ++*frees;
        if (!owned || pointer == 0) return;
        const CurrentContext current(*driver, context);
        driver->cuMemFree_v2(pointer);
    }
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the driver's addresses are integers
    void* native() const override { return reinterpret_cast<void*>(pointer); }
};

struct CudaKernel : Kernel::Impl {
    Function function = nullptr;
};

/// A kernel file compiled with one set of defines; its entries share it.
struct LoadedModule {
    Module module = nullptr;
    Image image; ///< without its bytes
};

/// Largest upload that is held back for a graph. A larger one and all later commands are submitted at once:
/// it takes about as long as the host needs for the rest of a frame's commands.
constexpr std::size_t max_held_back = std::size_t{64} << 10;

/// Page-locked memory for uploads in flight; uploads beyond it wait.
constexpr std::size_t max_staged = std::size_t{256} << 20;

/// The context must be current when the source is used.
Staging::Source page_locked(const Driver& driver) {
    const auto allocate = [&driver](std::size_t bytes) -> std::byte* {
        void* memory = nullptr;
        return driver.cuMemHostAlloc(&memory, bytes, 0) == 0 ? static_cast<std::byte*>(memory) : nullptr;
    };
    return {allocate, [&driver](std::byte* memory) { driver.cuMemFreeHost(memory); }};
}

/// CU_STREAM_LEGACY is another name of the default stream, which is null in all other calls.
Stream legacy_is_null(void* stream) {
    return reinterpret_cast<std::uintptr_t>(stream) == 1 ? nullptr : static_cast<Stream>(stream);
}

class CudaDevice : public Device {
public:
    /// Uses the device's primary context, on a new stream or on a given `stream` of the application.
    CudaDevice(std::shared_ptr<Libraries> libraries, DeviceHandle handle, std::size_t index,
               std::optional<Stream> stream = std::nullopt);
    CudaDevice(std::shared_ptr<Libraries> libraries, DeviceHandle handle, Context context, Stream stream);
    ~CudaDevice() override;

    const DeviceInfo& info() const override { return description_.info; }
    std::string clock() const override { return clock_ ? clock_->name() : expected_clock(driver()); }
    void* queue() const override { return stream_; }

private:
    std::shared_ptr<Buffer::Impl> do_allocate(std::size_t bytes) override;
    std::shared_ptr<Buffer::Impl> do_adopt(void* native) override;
    std::uint64_t do_upload(Buffer::Impl& to, std::span<const std::byte> from, std::size_t offset,
                            bool blocking) override;
    std::uint64_t do_download(const Buffer::Impl& from, std::span<std::byte> to, std::size_t offset) override;
    std::uint64_t do_clear(Buffer::Impl& buffer, std::size_t bytes, std::size_t offset) override;
    std::shared_ptr<Kernel::Impl> do_compile(const KernelSource& source, std::string_view entry,
                                             const Defines& defines) override;
    std::uint64_t do_launch(Kernel::Impl& kernel, Grid grid, std::span<const Argument> arguments) override;
    void do_finish() override;
    void do_follow(void* queue) override;
    bool do_begin_collecting() override;
    void do_end_collecting() override;
    void do_set_clocks(Clocks clocks) override;
    void do_profile(bool on) override;
    std::pair<std::int64_t, std::int64_t> do_interval(std::uint64_t ticket) override;

    /// `what` is text or a callable that makes it, called on failure only.
    template<class What>
    void check(Result result, std::string_view call, const What& what) const {
        if (result == 0) return;
        if constexpr (std::is_invocable_v<What>)
            fail(result, call, what());
        else
            fail(result, call, what);
    }
    [[noreturn]] void fail(Result result, std::string_view call, std::string_view what) const;
    /// Makes the device's context current during an operation, and restores the caller's.
    struct Scope {
        explicit Scope(const CudaDevice& device) : current(device.driver(), device.context_) {
            device.check(current.result(), "cuCtxSetCurrent", "starting a command");
        }
        CurrentContext current;
    };
    template<class What>
    void wait(const What& what);
    void check_launch(std::string_view entry, Grid grid, std::size_t arguments) const;
    /// Enqueues a command on `buffers`, or holds both back. Returns the ticket.
    std::uint64_t enqueue(const Command& command, std::span<Buffer::Impl* const> buffers);
    /// Enqueues a command after those held back, and waits for it.
    std::uint64_t enqueue_and_wait(const Command& command, bool staged);
    std::uint64_t enqueue_now(const Command& command);
    void submit_collected();
    /// As KernelFacts::occupancy.
    double occupancy(Function function, const Defines& defines) const;
    const LoadedModule& module(const KernelSource& source, const Defines& defines);
    const Driver& driver() const { return libraries_->driver; }
    /// Runs `submit`, timed when clocks are on. Returns the ticket.
    template<class Submit>
    std::uint64_t timed(const Submit& submit);

    std::shared_ptr<Libraries> libraries_;
    PrimaryContext primary_; ///< outlives everything below that frees memory in it
    Description description_;
    Context context_ = nullptr;
    Stream stream_ = nullptr;
    bool owned_ = true;
    EventHandle followed_ = nullptr;      ///< in the last stream that was followed; null before
    std::unique_ptr<CommandClock> clock_; ///< null until clocks are on for the first time
    bool timed_ = false;
    std::map<std::string, LoadedModule> modules_;
    Staging staging_{page_locked(libraries_->driver), max_staged};
    bool in_one_ = false;                                ///< within as_one()
    bool collects_ = false;                              ///< within as_one(), and commands are held back
    std::vector<Command> collected_;                     ///< held back
    std::vector<std::shared_ptr<Buffer::Impl>> buffers_; ///< of these commands, to keep them alive
    Graphs graphs_{libraries_->driver};
    std::shared_ptr<std::uint64_t> frees_ = std::make_shared<std::uint64_t>(0); ///< freed buffers so far
    std::uint64_t known_frees_ = 0; ///< frees_ when the graphs were last valid
};

CudaDevice::CudaDevice(std::shared_ptr<Libraries> libraries, DeviceHandle handle, std::size_t index,
                       std::optional<Stream> stream)
    : libraries_(std::move(libraries)),
      description_(describe(*libraries_, handle, fmt::format("cuda:{}", index))),
      owned_(!stream) {
    check(primary_.retain(driver(), handle, context_), "cuDevicePrimaryCtxRetain", "opening the device");
    if (stream) {
        stream_ = *stream;
        return;
    }
    const Scope scope(*this);
    constexpr unsigned non_blocking = 1; // CU_STREAM_NON_BLOCKING: no ordering with the default stream
    check(driver().cuStreamCreate(&stream_, non_blocking), "cuStreamCreate", "opening the device");
}

CudaDevice::CudaDevice(std::shared_ptr<Libraries> libraries, DeviceHandle handle, Context context,
                       Stream stream)
    : libraries_(std::move(libraries)),
      description_(describe(*libraries_, handle, "cuda:adopted")),
      context_(context),
      stream_(stream),
      owned_(false) {}

CudaDevice::~CudaDevice() {
    const CurrentContext current(driver(), context_);
    driver().cuStreamSynchronize(stream_);
    graphs_.drop();
    staging_.drop();
    clock_.reset();
    for (const auto& [key, loaded] : modules_) driver().cuModuleUnload(loaded.module);
    if (followed_ != nullptr) driver().cuEventDestroy_v2(followed_);
    if (owned_) driver().cuStreamDestroy_v2(stream_);
}

void CudaDevice::fail(Result result, std::string_view call, std::string_view what) const {
    // The handler of the error may free memory that commands in flight still use.
    if (context_ != nullptr && (stream_ != nullptr || !owned_)) {
        const CurrentContext current(driver(), context_);
        driver().cuStreamSynchronize(stream_);
    }
    throw_call_error(*libraries_, info(), result, call, what);
}

template<class Submit>
std::uint64_t CudaDevice::timed(const Submit& submit) {
    if (!timed_) {
        submit();
        return 0;
    }
    const auto check_clock = [&](CommandClock::Refusal refusal) {
        check(refusal.code, refusal.call, "timing a command");
    };
    check_clock(clock_->begin());
    try {
        submit();
        check_clock(clock_->end());
    } catch (...) {
        clock_->drop();
        throw;
    }
    return clock_->ticket();
}

void CudaDevice::do_set_clocks(Clocks clocks) {
    const Scope scope(*this);
    if (timed_) clock_->stop();
    timed_ = clocks == Clocks::on;
    if (timed_) clock_ = started_clock(std::move(clock_), driver(), stream_);
}

template<class What>
void CudaDevice::wait(const What& what) {
    submit_collected();
    check(driver().cuStreamSynchronize(stream_), "cuStreamSynchronize", what);
    staging_.release();
}

std::shared_ptr<Buffer::Impl> CudaDevice::do_allocate(std::size_t bytes) {
    const Scope scope(*this);
    auto buffer = std::make_shared<CudaBuffer>();
    buffer->driver = &driver();
    buffer->context = context_;
    buffer->frees = frees_;
    std::size_t free = 0;
    std::size_t total = 0;
    driver().cuMemGetInfo_v2(&free, &total);
    check(driver().cuMemAlloc_v2(&buffer->pointer, bytes), "cuMemAlloc",
          [&] { return fmt::format("allocating {} bytes with {} free of {}", bytes, free, total); });
    return buffer;
}

std::shared_ptr<Buffer::Impl> CudaDevice::do_adopt(void* native) {
    auto buffer = std::make_shared<CudaBuffer>();
    buffer->pointer = reinterpret_cast<DevicePointer>(native);
    buffer->owned = false;
    buffer->frees = frees_;
    return buffer;
}

std::uint64_t CudaDevice::enqueue_now(const Command& command) {
    return timed([&] {
        check(command.submit(driver(), stream_), command.call(), [&] { return command.describe(); });
    });
}

std::uint64_t CudaDevice::enqueue(const Command& command, std::span<Buffer::Impl* const> buffers) {
    if (!collects_) {
        if (in_one_) count_submissions(1);
        return enqueue_now(command);
    }
    collected_.push_back(command);
    for (auto* buffer : buffers) buffers_.push_back(buffer->shared_from_this());
    return 0;
}

/// `staged`: the host memory is page-locked, so it has the same address in the next frame.
std::uint64_t CudaDevice::enqueue_and_wait(const Command& command, bool staged) {
    std::uint64_t ticket = 0;
    if (collects_ && !staged) {
        submit_collected();
        ticket = enqueue_now(command);
        count_submissions(1);
    } else {
        ticket = enqueue(command, {});
    }
    wait([&] { return command.describe(); });
    return ticket;
}

/// The default stream cannot be captured.
bool CudaDevice::do_begin_collecting() {
    in_one_ = collects_ = stream_ != nullptr;
    return in_one_;
}

void CudaDevice::do_end_collecting() {
    in_one_ = collects_ = false;
    submit_collected();
}

void CudaDevice::submit_collected() {
    if (collected_.empty()) return;
    const Scope scope(*this);
    // An address may be reused for other memory, so graphs that use it become invalid.
    if (std::exchange(known_frees_, *frees_) != *frees_) {
        check(driver().cuStreamSynchronize(stream_), "cuStreamSynchronize",
              "waiting before graphs are destroyed");
        graphs_.drop();
    }
    std::uint64_t submissions = 0;
    const auto failure = graphs_.submit(collected_, stream_, submissions);
    count_submissions(submissions);
    collected_.clear();
    if (failure.code != 0) {
        const auto buffers = std::exchange(buffers_, {}); // kept alive until check() has waited
        check(failure.code, failure.call, failure.what);
    }
    buffers_.clear();
}

std::uint64_t CudaDevice::do_upload(Buffer::Impl& to, std::span<const std::byte> from, std::size_t offset,
                                    bool blocking) {
    const Scope scope(*this);
    if (collects_ && from.size() > max_held_back) {
        submit_collected();
        collects_ = false;
    }
    // A blocking upload reads the caller's pageable memory, as the paper's code did.
    auto* staged = blocking ? nullptr : staging_.take(from.size());
    if (staged != nullptr) std::memcpy(staged, from.data(), from.size());
    const Command command{.kind = Command::Kind::upload,
                          .device = static_cast<CudaBuffer&>(to).pointer + offset,
                          .host = staged != nullptr ? staged : const_cast<std::byte*>(from.data()),
                          .bytes = from.size(),
                          .label = to.label};
    if (staged == nullptr) {
        host_waited();
        return enqueue_and_wait(command, false);
    }
    const std::array<Buffer::Impl*, 1> buffers{&to};
    return enqueue(command, buffers);
}

std::uint64_t CudaDevice::do_download(const Buffer::Impl& from, std::span<std::byte> to, std::size_t offset) {
    const Scope scope(*this);
    constexpr std::size_t small = 65536;
    auto* staged = to.size() <= small ? staging_.take(to.size()) : nullptr;
    const Command command{.kind = Command::Kind::download,
                          .device = static_cast<const CudaBuffer&>(from).pointer + offset,
                          .host = staged != nullptr ? staged : to.data(),
                          .bytes = to.size(),
                          .label = from.label};
    const auto ticket = enqueue_and_wait(command, staged != nullptr);
    if (staged != nullptr) std::memcpy(to.data(), staged, to.size());
    return ticket;
}

std::uint64_t CudaDevice::do_clear(Buffer::Impl& buffer, std::size_t bytes, std::size_t offset) {
    const Scope scope(*this);
    const std::array<Buffer::Impl*, 1> buffers{&buffer};
    return enqueue({.kind = Command::Kind::clear,
                    .device = static_cast<CudaBuffer&>(buffer).pointer + offset,
                    .bytes = bytes,
                    .label = buffer.label},
                   buffers);
}

const LoadedModule& CudaDevice::module(const KernelSource& source, const Defines& defines) {
    std::string key(source.name);
    for (const auto& [name, value] : defines) key += fmt::format("|{}={}", name, value);
    if (const auto found = modules_.find(key); found != modules_.end()) return found->second;
    LoadedModule loaded;
    try {
        loaded.image = libraries_->nvrtc.compile(source, defines, description_.capability);
    } catch (const DeviceError& error) {
        throw DeviceError(fmt::format("{} ({}): {}", info().id, info().name, error.what()));
    }
    check(driver().cuModuleLoadData(&loaded.module, loaded.image.bytes.data()), "cuModuleLoadData",
          [&] { return fmt::format("loading {} ({})", source.name, loaded.image.target); });
    loaded.image.bytes.clear();
    return modules_[key] = std::move(loaded);
}

std::shared_ptr<Kernel::Impl> CudaDevice::do_compile(const KernelSource& source, std::string_view entry,
                                                     const Defines& defines) {
    const Scope scope(*this);
    const auto& loaded = module(source, defines);
    auto kernel = std::make_shared<CudaKernel>();
    const std::string name(entry);
    check(driver().cuModuleGetFunction(&kernel->function, loaded.module, name.c_str()), "cuModuleGetFunction",
          [&] { return fmt::format("looking for '{}' in {}", entry, source.name); });
    const auto ask = [&](FunctionAttribute what) -> std::int64_t {
        int value = -1;
        return driver().cuFuncGetAttribute(&value, what, kernel->function) == 0 ? value : -1;
    };
    kernel->facts.registers = ask(function_registers);
    kernel->facts.local_bytes = ask(function_shared_bytes);
    kernel->facts.max_group_size = ask(function_max_threads);
    kernel->facts.spill_bytes = use_of(loaded.image.log, entry).spill_bytes;
    kernel->facts.occupancy = occupancy(kernel->function, defines);
    return kernel;
}

/// A group occupies whole warps.
double CudaDevice::occupancy(Function function, const Defines& defines) const {
    const auto group_size = defines.find("GROUP_SIZE");
    if (driver().cuOccupancyMaxActiveBlocksPerMultiprocessor == nullptr || group_size == defines.end()
        || description_.threads_per_unit <= 0)
        return -1;
    constexpr int warp = 32;
    const int threads = std::stoi(group_size->second);
    int groups = 0;
    if (driver().cuOccupancyMaxActiveBlocksPerMultiprocessor(&groups, function, threads, 0) != 0) return -1;
    const int held = (threads + warp - 1) / warp * warp;
    return static_cast<double>(groups) * held / description_.threads_per_unit;
}

/// Earlier commands finish first, so that a profiler counts only commands between the two calls.
void CudaDevice::do_profile(bool on) {
    const auto call = on ? driver().cuProfilerStart : driver().cuProfilerStop;
    if (call == nullptr) return;
    do_finish();
    const Scope scope(*this);
    check(call(), on ? "cuProfilerStart" : "cuProfilerStop", "profiling");
}

std::uint64_t CudaDevice::do_launch(Kernel::Impl& kernel, Grid grid, std::span<const Argument> arguments) {
    const Scope scope(*this);
    check_launch(kernel.facts.entry, grid, arguments.size());
    Command command{.function = static_cast<CudaKernel&>(kernel).function,
                    .groups = static_cast<unsigned>(grid.groups),
                    .group_size = grid.group_size,
                    .arguments = arguments.size(),
                    .label = kernel.facts.entry};
    std::array<Buffer::Impl*, Command::max_arguments> buffers;
    std::size_t count = 0;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const auto& value = arguments[i].value();
        if (auto* const* buffer = std::get_if<Buffer::Impl*>(&value)) {
            buffers[count++] = *buffer;
            command.values[i] = static_cast<CudaBuffer*>(*buffer)->pointer;
        } else {
            command.values[i] = 0;
            const auto& scalar = std::get<Argument::Scalar>(value);
            std::memcpy(&command.values[i], scalar.bytes.data(), scalar.size);
        }
    }
    return enqueue(command, std::span(buffers).first(count));
}

void CudaDevice::check_launch(std::string_view entry, Grid grid, std::size_t arguments) const {
    if (arguments > Command::max_arguments)
        throw DeviceError(fmt::format("{}: '{}' with {} arguments; a launch takes at most {}", info().id,
                                      entry, arguments, Command::max_arguments));
    if (grid.groups > 0x7fffffffu)
        throw DeviceError(fmt::format("{}: '{}' with {} groups; a launch takes at most 2147483647", info().id,
                                      entry, grid.groups));
}

void CudaDevice::do_finish() {
    const Scope scope(*this);
    wait("waiting");
    if (timed_) clock_->collect();
}

void CudaDevice::do_follow(void* queue) {
    auto* const stream = legacy_is_null(queue);
    if (stream == stream_) return;
    const Scope scope(*this);
    constexpr unsigned untimed = 2; // CU_EVENT_DISABLE_TIMING
    constexpr std::string_view what = "following another stream";
    if (followed_ == nullptr) check(driver().cuEventCreate(&followed_, untimed), "cuEventCreate", what);
    check(driver().cuEventRecord(followed_, stream), "cuEventRecord", what);
    check(driver().cuStreamWaitEvent(stream_, followed_, 0), "cuStreamWaitEvent", what);
}

std::pair<std::int64_t, std::int64_t> CudaDevice::do_interval(std::uint64_t ticket) {
    const Scope scope(*this);
    const auto interval = clock_->interval(ticket);
    if (clock_->spent()) clock_ = started_clock(std::move(clock_), driver(), stream_);
    return interval;
}

} // namespace

Found discover() {
    Found found;
    try {
        const auto loaded = libraries();
        const int count = device_count(loaded->driver);
        for (int i = 0; i < count; ++i) {
            try {
                found.devices.push_back(std::make_unique<CudaDevice>(loaded, device_handle(loaded->driver, i),
                                                                     static_cast<std::size_t>(i)));
            } catch (const DeviceError& error) {
                found.reason = error.what();
            }
        }
        if (count == 0) found.reason = "cuda: the driver is installed, but it finds no device";
    } catch (const DeviceError& error) {
        found.reason = error.what();
    }
    return found;
}

std::unique_ptr<Device> on_stream(std::size_t index, void* stream) {
    const auto loaded = libraries();
    const int count = device_count(loaded->driver);
    if (index >= static_cast<std::size_t>(count))
        throw DeviceError(fmt::format("cuda:{}: the driver has {} devices, numbered from 0", index, count));
    return std::make_unique<CudaDevice>(loaded, device_handle(loaded->driver, static_cast<int>(index)), index,
                                        legacy_is_null(stream));
}

std::unique_ptr<Device> adopt(void* context, void* stream) {
    const auto loaded = libraries();
    DeviceHandle handle = 0;
    const CurrentContext current(loaded->driver, static_cast<Context>(context));
    auto code = current.result();
    if (code == 0) code = loaded->driver.cuCtxGetDevice(&handle);
    if (code != 0)
        throw DeviceError(
            fmt::format("cuda: the context cannot be adopted: {}", loaded->driver.describe(code)));
    return std::make_unique<CudaDevice>(loaded, handle, static_cast<Context>(context),
                                        static_cast<Stream>(stream));
}

} // namespace tandem::cuda
