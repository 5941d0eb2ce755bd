// SPDX-License-Identifier: MIT
#include "backends/cuda/cuda_device.h"

#include "backends/cuda/call_error.h"
#include "backends/cuda/current_context.h"
#include "backends/cuda/description.h"
#include "backends/cuda/modules.h"
#include "backends/cuda/primary_context.h"
#include "backends/cuda/queue.h"

#include <array>
#include <fmt/format.h>

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

    const DeviceInfo& info() const override { return description_.info; }
    std::string clock() const override { return queue_.clock(); }
    void* queue() const override { return queue_.stream(); }

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
    void do_finish() override { queue_.finish(); }
    void do_follow(void* queue) override { queue_.follow(legacy_is_null(queue)); }
    void do_precede(void* queue) override { queue_.precede(legacy_is_null(queue)); }
    bool do_is_captured() override { return queue_.is_captured(); }
    bool do_begin_collecting() override { return queue_.begin_collecting(); }
    void do_end_collecting() override { queue_.end_collecting(); }
    void do_set_clocks(Clocks clocks) override { queue_.set_clocks(clocks); }
    void do_profile(bool on) override;
    std::pair<std::int64_t, std::int64_t> do_interval(std::uint64_t ticket) override {
        return queue_.interval(ticket);
    }

    /// The primary context of a device, which it keeps alive.
    Context primary_context(DeviceHandle handle);
    void check_launch(std::string_view entry, Grid grid, std::size_t arguments) const;
    const Driver& driver() const { return libraries_->driver; }
    Queue::Counter counter() {
        return [this](std::uint64_t calls) { count_submissions(calls); };
    }

    std::shared_ptr<Libraries> libraries_;
    PrimaryContext primary_; ///< outlives everything below that frees memory in it
    Description description_;
    const Context context_;
    Modules modules_;
    Queue queue_; ///< its end waits, before modules are unloaded
};

CudaDevice::CudaDevice(std::shared_ptr<Libraries> libraries, DeviceHandle handle, std::size_t index,
                       std::optional<Stream> stream)
    : libraries_(std::move(libraries)),
      description_(describe(*libraries_, handle, fmt::format("cuda:{}", index))),
      context_(primary_context(handle)),
      modules_(*libraries_, description_, context_, queue_),
      queue_(*libraries_, description_.info, context_, stream, counter()) {}

CudaDevice::CudaDevice(std::shared_ptr<Libraries> libraries, DeviceHandle handle, Context context,
                       Stream stream)
    : libraries_(std::move(libraries)),
      description_(describe(*libraries_, handle, "cuda:adopted")),
      context_(context),
      modules_(*libraries_, description_, context_, queue_),
      queue_(*libraries_, description_.info, context_, stream, counter()) {}

Context CudaDevice::primary_context(DeviceHandle handle) {
    Context context = nullptr;
    if (const auto code = primary_.retain(driver(), handle, context); code != 0)
        throw_call_error(*libraries_, description_.info, code, "cuDevicePrimaryCtxRetain",
                         "opening the device");
    return context;
}

std::shared_ptr<Buffer::Impl> CudaDevice::do_allocate(std::size_t bytes) {
    const Queue::Scope scope(queue_);
    auto buffer = std::make_shared<CudaBuffer>();
    buffer->driver = &driver();
    buffer->context = context_;
    buffer->frees = queue_.frees();
    std::size_t free = 0;
    std::size_t total = 0;
    driver().cuMemGetInfo_v2(&free, &total);
    queue_.check(driver().cuMemAlloc_v2(&buffer->pointer, bytes), "cuMemAlloc",
                 [&] { return fmt::format("allocating {} bytes with {} free of {}", bytes, free, total); });
    return buffer;
}

std::shared_ptr<Buffer::Impl> CudaDevice::do_adopt(void* native) {
    auto buffer = std::make_shared<CudaBuffer>();
    buffer->pointer = reinterpret_cast<DevicePointer>(native);
    buffer->owned = false;
    return buffer;
}

std::uint64_t CudaDevice::do_upload(Buffer::Impl& to, std::span<const std::byte> from, std::size_t offset,
                                    bool blocking) {
    const Queue::Scope scope(queue_);
    queue_.prepare_upload(from.size());
    // A blocking upload reads the caller's pageable memory, as the paper's code did.
    auto* staged = blocking ? nullptr : queue_.staging().take(from.size());
    if (staged != nullptr) std::memcpy(staged, from.data(), from.size());
    const Command command{.kind = Command::Kind::upload,
                          .device = static_cast<CudaBuffer&>(to).pointer + offset,
                          .host = staged != nullptr ? staged : const_cast<std::byte*>(from.data()),
                          .bytes = from.size(),
                          .label = to.label};
    if (staged == nullptr) {
        host_waited();
        return queue_.enqueue_and_wait(command, false);
    }
    const std::array<Buffer::Impl*, 1> buffers{&to};
    return queue_.enqueue(command, buffers);
}

std::uint64_t CudaDevice::do_download(const Buffer::Impl& from, std::span<std::byte> to, std::size_t offset) {
    const Queue::Scope scope(queue_);
    constexpr std::size_t small = 65536;
    auto* staged = to.size() <= small ? queue_.staging().take(to.size()) : nullptr;
    const Command command{.kind = Command::Kind::download,
                          .device = static_cast<const CudaBuffer&>(from).pointer + offset,
                          .host = staged != nullptr ? staged : to.data(),
                          .bytes = to.size(),
                          .label = from.label};
    const auto ticket = queue_.enqueue_and_wait(command, staged != nullptr);
    if (staged != nullptr) std::memcpy(to.data(), staged, to.size());
    return ticket;
}

std::uint64_t CudaDevice::do_clear(Buffer::Impl& buffer, std::size_t bytes, std::size_t offset) {
    const Queue::Scope scope(queue_);
    const std::array<Buffer::Impl*, 1> buffers{&buffer};
    return queue_.enqueue({.kind = Command::Kind::clear,
                           .device = static_cast<CudaBuffer&>(buffer).pointer + offset,
                           .bytes = bytes,
                           .label = buffer.label},
                          buffers);
}

std::shared_ptr<Kernel::Impl> CudaDevice::do_compile(const KernelSource& source, std::string_view entry,
                                                     const Defines& defines) {
    return modules_.compile(source, entry, defines);
}

/// Earlier commands finish first, so that a profiler counts only commands between the two calls.
void CudaDevice::do_profile(bool on) {
    const auto call = on ? driver().cuProfilerStart : driver().cuProfilerStop;
    if (call == nullptr) return;
    do_finish();
    const Queue::Scope scope(queue_);
    queue_.check(call(), on ? "cuProfilerStart" : "cuProfilerStop", "profiling");
}

std::uint64_t CudaDevice::do_launch(Kernel::Impl& kernel, Grid grid, std::span<const Argument> arguments) {
    const Queue::Scope scope(queue_);
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
    return queue_.enqueue(command, std::span(buffers).first(count));
}

void CudaDevice::check_launch(std::string_view entry, Grid grid, std::size_t arguments) const {
    if (arguments > Command::max_arguments)
        throw DeviceError(fmt::format("{}: '{}' with {} arguments; a launch takes at most {}", info().id,
                                      entry, arguments, Command::max_arguments));
    if (grid.groups > 0x7fffffffu)
        throw DeviceError(fmt::format("{}: '{}' with {} groups; a launch takes at most 2147483647", info().id,
                                      entry, grid.groups));
}

} // namespace

BackendReport discover() {
    BackendReport found;
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
