// SPDX-License-Identifier: MIT
#pragma once

#include "backends/trace.h"

#include <chrono>
#include <cstddef>
#include <cstring>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

namespace tandem {

/// A device failed or cannot do what was asked: backend, call, code and what was being done, in one line.
struct DeviceError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct DeviceInfo {
    std::string id;       ///< "host", "opencl:0", "cuda:0"
    std::string name;     ///< as the vendor calls it
    std::string driver;   ///< driver or runtime version
    std::string compiler; ///< what compiles kernels
    std::string hardware; ///< PCI address or UUID; empty when unknown
    bool is_gpu = false;
    std::uint32_t compute_units = 1;
    std::uint32_t max_group_size = 1;
    std::uint64_t global_bytes = 0;
    std::uint64_t max_allocation = 0;
    std::uint64_t local_bytes = 0;
    bool has_double = true;
    bool has_directed_rounding = false; ///< kernels can add rounding down and up
    bool stages_pinned = false;         ///< uploads that do not block go through page-locked memory
};

/// Compile-time parameters of a kernel: name -> value, emitted as defines under the same names.
using Defines = std::map<std::string, std::string>;

/// A kernel file with its headers, flattened into one text.
struct KernelSource {
    std::string_view name; ///< "algorithms/chunked/chunked.cl"
    std::string_view text;
};

/// Device memory. Move-only in spirit: copies share it; dies before its device.
class Buffer {
public:
    struct Impl {
        virtual ~Impl() = default;
        std::size_t bytes = 0;
        std::string label;
    };

    Buffer() = default;
    explicit Buffer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

    explicit operator bool() const { return impl_ != nullptr; }
    std::size_t bytes() const { return impl_ ? impl_->bytes : 0; }
    Impl& impl() const { return *impl_; }

private:
    std::shared_ptr<Impl> impl_;
};

/// What compiling a kernel cost and what it uses; -1 = the backend does not tell.
struct KernelFacts {
    std::string entry;
    Defines defines;
    double compile_ms = 0;
    std::int64_t registers = -1;
    std::int64_t local_bytes = -1;
    std::int64_t spill_bytes = -1;
    std::int64_t max_group_size = -1;
};

/// A compiled entry point; a cheap handle.
class Kernel {
public:
    struct Impl {
        virtual ~Impl() = default;
        KernelFacts facts;
    };

    Kernel() = default;
    explicit Kernel(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

    const KernelFacts& facts() const { return impl_->facts; }
    Impl& impl() const { return *impl_; }

private:
    std::shared_ptr<Impl> impl_;
};

/// A buffer or a scalar of at most 8 bytes.
class Argument {
public:
    struct Scalar {
        std::array<std::byte, 8> bytes{};
        std::size_t size = 0;
    };

    Argument(const Buffer& buffer) : value_(&buffer.impl()) {}
    template<class T>
    requires(std::is_arithmetic_v<T> && sizeof(T) <= 8) Argument(T scalar) {
        Scalar copy;
        copy.size = sizeof(T);
        std::memcpy(copy.bytes.data(), &scalar, sizeof(T));
        value_ = copy;
    }

    const std::variant<Buffer::Impl*, Scalar>& value() const { return value_; }

private:
    std::variant<Buffer::Impl*, Scalar> value_;
};

/// One-dimensional grid: groups x group_size work-items.
struct Grid {
    std::uint64_t groups = 1;
    std::uint32_t group_size = 1;
};

/// Whether commands carry device timestamps. Without them nothing but the span of a frame is timed.
enum class Clocks { off, on };

/// One device of one backend. The public functions record what they do in the trace and leave the doing to
/// the private ones, so that a command cannot run unrecorded nor be recorded twice. Commands run in order.
/// Not thread-safe. Every function may throw DeviceError.
class Device {
public:
    virtual ~Device() = default;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    virtual const DeviceInfo& info() const = 0;

    /// Throws DeviceError that says how much was asked for and how much there is.
    Buffer allocate(std::size_t bytes, std::string_view label);
    /// Wraps memory of a host application's context: a cl_mem or a device pointer, which must outlive the
    /// buffer.
    Buffer adopt(void* native, std::size_t bytes, std::string_view label);

    /// Copies `from` to `to` at `offset`. Returns at once (the bytes are copied first) unless `blocking`.
    void upload(const Buffer& to, std::span<const std::byte> from, std::size_t offset = 0,
                bool blocking = false);
    /// Copies from `from` at `offset`; waits for it.
    void download(const Buffer& from, std::span<std::byte> to, std::size_t offset = 0);
    /// Sets `bytes` bytes at `offset` to zero.
    void clear(const Buffer& buffer, std::size_t bytes, std::size_t offset = 0);

    /// Compiles once per (source, entry, defines) and device.
    Kernel compile(const KernelSource& source, std::string_view entry, const Defines& defines);
    void launch(const Kernel& kernel, Grid grid, std::span<const Argument> arguments);

    /// Waits for everything submitted so far and returns its trace, with device times filled in.
    Trace finish();

    /// Books what follows under `stage`; returns the stage before.
    Stage set_stage(Stage stage);
    /// Waits, then switches timestamps on or off.
    void set_clocks(Clocks clocks);
    Clocks clocks() const { return clocks_; }

    /// The facts of every kernel asked for since the last call; compile_ms is 0 for those that were there
    /// already.
    std::vector<KernelFacts> take_kernels();
    std::size_t bytes_allocated() const;

protected:
    Device() = default;

private:
    friend class HostWork;

    virtual std::shared_ptr<Buffer::Impl> do_allocate(std::size_t bytes) = 0;
    virtual std::shared_ptr<Buffer::Impl> do_adopt(void* native) = 0;
    virtual std::uint64_t do_upload(Buffer::Impl& to, std::span<const std::byte> from, std::size_t offset,
                                    bool blocking) = 0;
    virtual std::uint64_t do_download(const Buffer::Impl& from, std::span<std::byte> to,
                                      std::size_t offset) = 0;
    virtual std::uint64_t do_clear(Buffer::Impl& buffer, std::size_t bytes, std::size_t offset) = 0;
    virtual std::shared_ptr<Kernel::Impl> do_compile(const KernelSource& source, std::string_view entry,
                                                     const Defines& defines) = 0;
    virtual std::uint64_t do_launch(Kernel::Impl& kernel, Grid grid, std::span<const Argument> arguments) = 0;
    virtual void do_finish() = 0;
    virtual void do_set_clocks(Clocks clocks) = 0;
    /// Begin and duration in device nanoseconds of a finished command; releases the ticket.
    virtual std::pair<std::int64_t, std::int64_t> do_interval(std::uint64_t ticket) = 0;

    void record(Event event, std::chrono::steady_clock::time_point begin);

    std::map<std::string, Kernel> kernels_;
    std::vector<KernelFacts> asked_;
    std::shared_ptr<std::size_t> allocated_ = std::make_shared<std::size_t>(0);
    Trace trace_;
    Stage stage_ = Stage::write;
    Clocks clocks_ = Clocks::off;
};

/// Books commands of its lifetime under a stage.
class StageScope {
public:
    StageScope(Device& device, Stage stage) : device_(device), before_(device.set_stage(stage)) {}
    ~StageScope() { device_.set_stage(before_); }
    StageScope(const StageScope&) = delete;
    StageScope& operator=(const StageScope&) = delete;

private:
    Device& device_;
    Stage before_;
};

/// Times host work that belongs to a stage; the only clock outside the device's commands.
class HostWork {
public:
    HostWork(Device& device, Stage stage, std::string_view label);
    ~HostWork();
    HostWork(const HostWork&) = delete;
    HostWork& operator=(const HostWork&) = delete;

private:
    Device& device_;
    Stage stage_;
    std::string label_;
    std::chrono::steady_clock::time_point begin_;
};

template<class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
    return std::as_bytes(std::span(values));
}

} // namespace tandem
