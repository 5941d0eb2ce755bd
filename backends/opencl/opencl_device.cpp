// SPDX-License-Identifier: MIT
#include "backends/opencl/opencl_device.h"

#include "backends/opencl/call_error.h"
#include "backends/opencl/description.h"
#include "backends/opencl/drivers.h"
#include "backends/opencl/programs.h"
#include "backends/opencl/queue.h"
#include "base/error.h"

#include <array>
#include <fmt/format.h>

namespace tandem::opencl {

namespace {

/// For clCreateBuffer, which reports a size beyond the device's as invalid.
bool is_out_of_memory(cl_int code) {
    return code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_RESOURCES
           || code == CL_OUT_OF_HOST_MEMORY || code == CL_INVALID_BUFFER_SIZE;
}

struct OpenclBuffer : Buffer::Impl {
    cl_mem memory = nullptr;
    bool owned = true;
    OpenclBuffer() = default;
    OpenclBuffer(const OpenclBuffer&) = delete;
    OpenclBuffer& operator=(const OpenclBuffer&) = delete;
    ~OpenclBuffer() override {
        if (owned && memory) clReleaseMemObject(memory);
    }
    void* native() const override { return memory; }
};

/// A context, which it releases only when it has made it.
class Context {
public:
    Context(const DeviceInfo& info, cl_device_id device) : owned_(true) {
        cl_int code = CL_SUCCESS;
        handle_ = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &code);
        if (code != CL_SUCCESS) throw_call_error(info, code, "clCreateContext", "opening the device");
    }
    explicit Context(cl_context adopted) : handle_(adopted) {}
    ~Context() {
        if (owned_) clReleaseContext(handle_);
    }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    cl_context handle() const { return handle_; }

private:
    cl_context handle_ = nullptr;
    bool owned_ = false;
};

class OpenclDevice : public Device {
public:
    OpenclDevice(cl_device_id device, std::size_t index);
    OpenclDevice(cl_context context, cl_device_id device, cl_command_queue queue);

    const DeviceInfo& info() const override { return info_; }
    std::string clock() const override { return "OpenCL profiling"; }
    void* queue() const override { return queue_.active(); }

private:
    std::shared_ptr<Buffer::Impl> do_allocate(std::size_t bytes) override;
    std::shared_ptr<Buffer::Impl> do_adopt(void* native) override;
    std::uint64_t do_upload(Buffer::Impl& to, std::span<const std::byte> from, std::size_t offset,
                            bool blocking) override;
    std::uint64_t do_download(const Buffer::Impl& from, std::span<std::byte> to, std::size_t offset) override;
    std::uint64_t do_clear(Buffer::Impl& buffer, std::size_t bytes, std::size_t offset) override;
    std::shared_ptr<Kernel::Impl> do_compile(const KernelSource& source, std::string_view entry,
                                             const Defines& defines) override {
        return programs_.compile(queue_, source, entry, defines);
    }
    std::uint64_t do_launch(Kernel::Impl& kernel, Grid grid, std::span<const Argument> arguments) override;
    void do_finish() override { queue_.finish(); }
    void do_follow(void* queue) override { queue_.follow(static_cast<cl_command_queue>(queue)); }
    void do_precede(void* queue) override {
        if (queue != queue_.active()) queue_.finish();
    }
    void do_set_clocks(Clocks clocks) override { queue_.set_clocks(clocks); }
    std::pair<std::int64_t, std::int64_t> do_interval(std::uint64_t ticket) override {
        return queue_.interval(ticket);
    }

    void set_arguments(cl_kernel kernel, std::span<const Argument> arguments, std::string_view entry);

    DeviceInfo info_;
    Context context_;
    Programs programs_;
    Queue queue_; ///< its end waits, before programs are released
};

OpenclDevice::OpenclDevice(cl_device_id device, std::size_t index)
    : info_(describe(device, fmt::format("opencl:{}", index))),
      context_(info_, device),
      programs_(info_, device, context_.handle()),
      queue_(info_, device, context_.handle()) {}

OpenclDevice::OpenclDevice(cl_context context, cl_device_id device, cl_command_queue queue)
    : info_(describe(device, "opencl:adopted")),
      context_(context),
      programs_(info_, device, context),
      queue_(info_, queue) {}

std::shared_ptr<Buffer::Impl> OpenclDevice::do_allocate(std::size_t bytes) {
    auto buffer = std::make_shared<OpenclBuffer>();
    cl_int code = CL_SUCCESS;
    buffer->memory = clCreateBuffer(context_.handle(), CL_MEM_READ_WRITE, bytes, nullptr, &code);
    const auto what = [&] {
        return fmt::format("allocating {} bytes of {} with {} in use", bytes, info_.global_bytes,
                           bytes_allocated());
    };
    try {
        queue_.check(code, "clCreateBuffer", what);
    } catch (const DeviceError& error) {
        if (is_out_of_memory(code)) throw OutOfMemory(error.what());
        throw;
    }
    return buffer;
}

std::shared_ptr<Buffer::Impl> OpenclDevice::do_adopt(void* native) {
    auto buffer = std::make_shared<OpenclBuffer>();
    buffer->memory = static_cast<cl_mem>(native);
    buffer->owned = false;
    return buffer;
}

std::uint64_t OpenclDevice::do_upload(Buffer::Impl& to, std::span<const std::byte> from, std::size_t offset,
                                      bool blocking) {
    auto* copy = blocking ? nullptr : queue_.staging().take(from.size());
    if (copy != nullptr) std::memcpy(copy, from.data(), from.size());
    const void* source = copy != nullptr ? copy : from.data();
    const auto ticket = queue_.submit(
        "clEnqueueWriteBuffer",
        [&](cl_event* event) {
            return clEnqueueWriteBuffer(queue_.active(), static_cast<OpenclBuffer&>(to).memory,
                                        copy != nullptr ? CL_FALSE : CL_TRUE, offset, from.size(), source, 0,
                                        nullptr, event);
        },
        [&] { return fmt::format("uploading '{}'", to.label); });
    if (copy != nullptr) return ticket;
    host_waited();
    queue_.staging().release(); // the queue is in order: earlier uploads are complete
    return ticket;
}

std::uint64_t OpenclDevice::do_download(const Buffer::Impl& from, std::span<std::byte> to,
                                        std::size_t offset) {
    const auto ticket = queue_.submit(
        "clEnqueueReadBuffer",
        [&](cl_event* event) {
            return clEnqueueReadBuffer(queue_.active(), static_cast<const OpenclBuffer&>(from).memory,
                                       CL_TRUE, offset, to.size(), to.data(), 0, nullptr, event);
        },
        [&] { return fmt::format("downloading '{}'", from.label); });
    queue_.staging().release();
    return ticket;
}

std::uint64_t OpenclDevice::do_clear(Buffer::Impl& buffer, std::size_t bytes, std::size_t offset) {
    // Small clears are writes: Oclgrind 21.10 treats memory that clEnqueueFillBuffer fills as uninitialised.
    static const std::array<std::byte, 65536> zeros{};
    const cl_uchar zero = 0;
    auto* memory = static_cast<OpenclBuffer&>(buffer).memory;
    const auto what = [&] { return fmt::format("clearing '{}'", buffer.label); };
    if (bytes <= zeros.size())
        return queue_.submit(
            "clEnqueueWriteBuffer",
            [&](cl_event* event) {
                return clEnqueueWriteBuffer(queue_.active(), memory, CL_FALSE, offset, bytes, zeros.data(), 0,
                                            nullptr, event);
            },
            what);
    return queue_.submit(
        "clEnqueueFillBuffer",
        [&](cl_event* event) {
            return clEnqueueFillBuffer(queue_.active(), memory, &zero, 1, offset, bytes, 0, nullptr, event);
        },
        what);
}

void OpenclDevice::set_arguments(cl_kernel kernel, std::span<const Argument> arguments,
                                 std::string_view entry) {
    for (cl_uint i = 0; i < arguments.size(); ++i) {
        const auto& value = arguments[i].value();
        cl_int code = CL_SUCCESS;
        if (const auto* const* buffer = std::get_if<Buffer::Impl*>(&value)) {
            code =
                clSetKernelArg(kernel, i, sizeof(cl_mem), &static_cast<const OpenclBuffer*>(*buffer)->memory);
        } else {
            const auto& scalar = std::get<Argument::Scalar>(value);
            code = clSetKernelArg(kernel, i, scalar.size, scalar.bytes.data());
        }
        queue_.check(code, "clSetKernelArg",
                     [&] { return fmt::format("setting argument {} of '{}'", i, entry); });
    }
}

std::uint64_t OpenclDevice::do_launch(Kernel::Impl& kernel, Grid grid, std::span<const Argument> arguments) {
    auto* handle = static_cast<OpenclKernel&>(kernel).kernel;
    set_arguments(handle, arguments, kernel.facts.entry);
    const std::size_t local = grid.group_size;
    const std::size_t global = grid.groups * local;
    return queue_.submit(
        "clEnqueueNDRangeKernel",
        [&](cl_event* event) {
            return clEnqueueNDRangeKernel(queue_.active(), handle, 1, nullptr, &global, &local, 0, nullptr,
                                          event);
        },
        [&] {
            return fmt::format("launching '{}' with {} groups of {}", kernel.facts.entry, grid.groups, local);
        });
}

/// Adds a sentence part to the reason why devices are missing.
void add_part(std::string& reason, const std::string& part) {
    reason += reason.empty() ? fmt::format("opencl: {}", part) : fmt::format("; {}", part);
}

} // namespace

BackendReport discover() {
    auto listing = list_devices();
    BackendReport found;
    found.drivers = registered_drivers();
    found.reason = std::move(listing.reason);
    for (const auto& driver : found.drivers)
        if (!driver.problem.empty()) add_part(found.reason, sentence(driver));
    for (auto* device : listing.devices) {
        try {
            found.devices.push_back(std::make_unique<OpenclDevice>(device, found.devices.size()));
        } catch (const DeviceError& error) {
            add_part(found.reason, error.what());
        }
    }
    return found;
}

namespace {

/// Throws InputError unless commands of the queue, which must be of this context, run one after the other.
void check_adopted(cl_context context, cl_device_id device, cl_command_queue queue) {
    if (context == nullptr || device == nullptr || queue == nullptr)
        throw InputError("opencl::adopt: a null context, device or queue; give the application's");
    cl_command_queue_properties properties = 0;
    cl_context own = nullptr;
    if (clGetCommandQueueInfo(queue, CL_QUEUE_PROPERTIES, sizeof properties, &properties, nullptr)
            != CL_SUCCESS
        || clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof(void*), &own, nullptr) != CL_SUCCESS)
        throw InputError("opencl::adopt: not a command queue; give the application's");
    if (own != context) throw InputError("opencl::adopt: the queue is of another context; give its own");
    if ((properties & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE) != 0)
        throw InputError("opencl::adopt: the queue is out-of-order; give an in-order one");
}

} // namespace

std::unique_ptr<Device> adopt(void* context, void* device, void* queue) {
    check_adopted(static_cast<cl_context>(context), static_cast<cl_device_id>(device),
                  static_cast<cl_command_queue>(queue));
    return std::make_unique<OpenclDevice>(static_cast<cl_context>(context), static_cast<cl_device_id>(device),
                                          static_cast<cl_command_queue>(queue));
}

} // namespace tandem::opencl
