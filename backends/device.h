// SPDX-License-Identifier: MIT
#pragma once

#include "backends/trace.h"

#include <chrono>
#include <cstddef>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

namespace tandem {

class BufferGuards;

/// A device failed or cannot do what was asked: backend, call, code and what was being done, in one line.
/// What the device was asked for before is no longer in flight, or can never be waited for.
struct DeviceError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Memory does not suffice: what was asked for and what there is. Comes from allocate(), and from later
/// commands where memory is taken at first use (DeviceInfo::allocates_late) or a kernel needs some of its
/// own. The device works on; dropping buffers helps.
struct OutOfMemory : DeviceError {
    using DeviceError::DeviceError;
};

/// What a device is; sizes in bytes.
struct DeviceInfo {
    std::string id;       ///< "host", "opencl:0", "cuda:0"
    std::string name;     ///< as the vendor calls it
    std::string driver;   ///< driver or runtime version
    std::string compiler; ///< what compiles kernels
    std::string hardware; ///< PCI address or UUID; empty when unknown
    bool is_gpu = false;
    std::uint32_t compute_units = 1;    ///< what runs work-groups side by side: multiprocessors, cores
    std::uint32_t max_group_size = 1;   ///< work-items; a kernel may take fewer
    std::uint32_t cores = 0;            ///< that add and multiply in float at once, in all; 0: unknown
    std::uint32_t clock_mhz = 0;        ///< at most; 0: unknown
    std::uint64_t peak_bytes_per_s = 0; ///< of memory, by its clock and width; 0: unknown
    std::uint64_t global_bytes = 0;     ///< device memory in all, whoever uses it
    std::uint64_t max_allocation = 0;   ///< the most that one buffer holds
    std::uint64_t local_bytes = 0;      ///< memory of a work-group
    bool allocates_late = false;        ///< memory is taken at first use, so that allocate() has to count
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

/// Device memory, freed with the last copy of its handle; dies before its device. Freeing never fails.
class Buffer {
public:
    /// What an adaptor adds its handle to.
    struct Impl : std::enable_shared_from_this<Impl> {
        virtual ~Impl() = default;
        /// What Device::adopt takes.
        virtual void* native() const = 0;
        std::size_t bytes = 0; ///< at least what was asked for
        std::string label;     ///< names it in traces and errors
    };

    Buffer() = default;
    explicit Buffer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

    explicit operator bool() const { return impl_ != nullptr; }
    std::size_t bytes() const { return impl_ ? impl_->bytes : 0; }
    Impl& impl() const { return *impl_; } ///< not of an empty handle
    /// The memory by the vendor's own handle, which this one frees: a pointer of the host's or of CUDA's, a
    /// cl_mem of OpenCL's; null of an empty handle.
    void* native() const { return impl_ ? impl_->native() : nullptr; }

private:
    std::shared_ptr<Impl> impl_;
};

/// What compiling a kernel cost and what it uses; -1 = the backend does not tell.
struct KernelFacts {
    std::string entry;
    Defines defines;
    double compile_ms = 0;            ///< 0 when it was there already
    std::int64_t registers = -1;      ///< a work-item's
    std::int64_t local_bytes = -1;    ///< a work-group's
    std::int64_t spill_bytes = -1;    ///< stores and loads of a work-item
    std::int64_t max_group_size = -1; ///< work-items; more are refused by launch()
    /// Share of the work-items that a compute unit can hold which groups of GROUP_SIZE fill at most, as far
    /// as registers and local memory let them; negative where the backend does not tell.
    double occupancy = -1;
};

/// A compiled entry point of one device; a cheap handle.
class Kernel {
public:
    struct Impl {
        virtual ~Impl() = default;
        KernelFacts facts;
    };

    Kernel() = default;
    explicit Kernel(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

    explicit operator bool() const { return impl_ != nullptr; }

    const KernelFacts& facts() const { return impl_->facts; }
    Impl& impl() const { return *impl_; }

private:
    std::shared_ptr<Impl> impl_;
};

/// A kernel's argument: a buffer, which has to outlive the call, or a scalar of at most 8 bytes, whose type
/// has the size of the kernel's parameter.
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

/// One-dimensional grid: groups x group_size work-items. `group_size` is the define GROUP_SIZE of the kernel.
struct Grid {
    std::uint64_t groups = 1;
    std::uint32_t group_size = 1;
};

/// Whether commands are recorded, with device timestamps. Off, which is the default: no clock is read, no
/// event made and nothing kept from one command to the next.
enum class Clocks { off, on };

/// One device of one backend. The public functions record what they do in the trace, where clocks are on, and
/// leave the doing to the private ones, so that a command cannot run unrecorded nor be recorded twice.
/// A command (upload, download, clear, launch) belongs to a stage of a frame: outside any StageScope it
/// throws std::logic_error that names it, whether clocks are on or off. Commands run in order. A device is
/// used from one thread at a time; two devices may be used from two. A thread's current CUDA context is left
/// as it was. Every function may throw DeviceError.
class Device {
public:
    virtual ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    virtual const DeviceInfo& info() const = 0;
    /// By what device times are taken: "CUPTI 13.0 activity records", "CUDA events" and, where these stand in
    /// for something better, why. Certain once clocks have been on: a library that only they need is opened
    /// then. It may change while they are on, after a failure.
    virtual std::string clock() const = 0;
    /// What commands go to, by the vendor's own handle: a CUstream of CUDA's, whose default stream is null; a
    /// cl_command_queue of OpenCL's; null of the host's.
    virtual void* queue() const = 0;
    /// Commands from now on come after what was given to `queue` so far, a vendor's handle of this device's
    /// context. The host waits for it where no command does: on OpenCL.
    void follow(void* queue) { do_follow(queue); }

    /// Memory of at least `bytes` bytes, their values unknown. Throws OutOfMemory that says how much was
    /// asked for, what is in use and how much there is.
    Buffer allocate(std::size_t bytes, std::string_view label);
    /// Wraps memory of a host application's context: a cl_mem or a device pointer, which must outlive the
    /// buffer. It does not count as allocated.
    Buffer adopt(void* native, std::size_t bytes, std::string_view label);

    /// Copies `from` to `to` at byte `offset`. Unless `blocking` it returns at once with the bytes copied; it
    /// waits where copies of uploads in flight have come to fill their memory (tens of MiB).
    void upload(const Buffer& to, std::span<const std::byte> from, std::size_t offset = 0,
                bool blocking = false);
    /// Copies from `from` at byte `offset`; waits for it.
    void download(const Buffer& from, std::span<std::byte> to, std::size_t offset = 0);
    /// Sets `bytes` bytes at `offset` to zero.
    void clear(const Buffer& buffer, std::size_t bytes, std::size_t offset = 0);

    /// Compiles once per (source, entry, defines) and device. Throws DeviceError with the compiler's log in
    /// one line.
    Kernel compile(const KernelSource& source, std::string_view entry, const Defines& defines);
    /// Runs a kernel with its arguments in order; no groups are no launch. Throws DeviceError when the groups
    /// are larger than the kernel can take.
    void launch(const Kernel& kernel, Grid grid, std::span<const Argument> arguments);

    /// Runs `work`, whose commands go to the device as one submission where it knows how and the same
    /// commands have come before: a frame after another. A command that waits ends it, and begins the next.
    /// Where the device does not know how, and with clocks on, commands go one by one. `work` may throw; what
    /// it enqueued before is submitted. An error of a command may come with a later one, or at the end.
    template<class Work>
    void as_one(const Work& work) {
        if (clocks_ == Clocks::on || collecting_ || !do_begin_collecting()) {
            work();
            return;
        }
        collecting_ = true;
        try {
            work();
        } catch (...) {
            collecting_ = false;
            do_end_collecting();
            throw;
        }
        collecting_ = false;
        do_end_collecting();
    }

    /// How often work was handed to the device so far: commands, and those of as_one that went together once.
    std::uint64_t submissions() const { return submissions_; }

    /// Waits for everything submitted so far and returns its trace, with device times filled in; an empty one
    /// where clocks are off.
    Trace finish();

    /// Waits, drops what was recorded since the last finish(), then switches clocks on or off. On CUDA the
    /// last device to switch them off detaches a profiling library from the driver: no other thread may be in
    /// a call of the driver then (cuda/activity.h).
    void set_clocks(Clocks clocks);
    Clocks clocks() const { return clocks_; }

    /// How many threads run the work-groups of a launch where that is the host's to do; 0, which is the
    /// default: one for each core. Answers do not depend on it. Other devices have work-items of their own,
    /// and ignore it.
    void set_threads(std::uint32_t threads) { do_set_threads(threads); }

    /// Tells a profiler that is attached to the process to begin or to end here; nothing where the backend
    /// has no such call.
    void profile(bool on) { do_profile(on); }

    /// The facts of every kernel asked for since the last call, each once; compile_ms is 0 for those that
    /// were there already.
    std::vector<KernelFacts> take_kernels();

    /// Bytes of the buffers that live, without adopted ones.
    std::size_t bytes_allocated() const;
    /// From now on allocate() throws OutOfMemory where bytes_allocated() would exceed `bytes`. What is
    /// allocated already stays.
    void set_memory_limit(std::size_t bytes) { memory_limit_ = bytes; }
    /// no_memory_limit unless one was set.
    std::size_t memory_limit() const { return memory_limit_; }
    static constexpr std::size_t no_memory_limit = std::numeric_limits<std::size_t>::max();

    /// For tests. From now on each new buffer is followed by a byte pattern (buffer_guards.h), which
    /// check_guards() verifies. Traces and bytes_allocated() do not change.
    void guard_buffers();
    /// Waits, and throws std::logic_error where something was written past the end of a guarded buffer,
    /// whether it still lives or was freed since the last call. Does nothing without guard_buffers().
    void check_guards() {
        if (guards_) do_check_guards();
    }

protected:
    Device();

    /// For an adaptor that collects: it has handed commands over in so many calls.
    void count_submissions(std::uint64_t calls) { submissions_ += calls; }
    /// For an adaptor whose command had to wait although it need not have: the trace says so.
    void host_waited() { waited_ = true; }

private:
    friend class BufferGuards;
    friend class HostWork;
    friend class StageScope;

    struct Compiled {
        Kernel kernel;
        bool asked = false; ///< its facts stand in asked_
    };

    // What an adaptor does. A command returns the ticket of its timestamps, 0 where clocks are off; ranges
    // and group sizes have been checked. Text is made of failures only.

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
    virtual void do_follow(void* queue) = 0;
    /// From here on commands may be kept back until the end, or until one that waits; false: they are not.
    virtual bool do_begin_collecting() { return false; }
    /// Submits what was kept back. Counts with count_submissions what was handed over since the begin.
    virtual void do_end_collecting() {}
    virtual void do_set_clocks(Clocks clocks) = 0;
    virtual void do_set_threads(std::uint32_t) {}
    virtual void do_profile(bool) {}
    /// Begin and duration in device nanoseconds of a finished command; releases the ticket.
    virtual std::pair<std::int64_t, std::int64_t> do_interval(std::uint64_t ticket) = 0;

    void check_capacity(std::size_t bytes, std::string_view label) const;
    void do_check_guards();
    /// Fills in the device times of what was recorded and releases all tickets.
    void read_times();
    /// Runs `work`, which returns a ticket, and records it where clocks are on.
    template<class Work>
    void submit(Event event, std::string_view label, const Work& work);
    void record(Event event, std::chrono::steady_clock::time_point begin);
    std::optional<Stage> set_stage(std::optional<Stage> stage) { return std::exchange(stage_, stage); }

    std::map<std::string, Compiled> kernels_;
    std::vector<KernelFacts> asked_;
    std::shared_ptr<std::size_t> allocated_ = std::make_shared<std::size_t>(0);
    std::size_t memory_limit_ = no_memory_limit;
    std::shared_ptr<BufferGuards> guards_; ///< none unless asked for
    Trace trace_;
    std::optional<Stage> stage_; ///< none outside every StageScope
    Clocks clocks_ = Clocks::off;
    bool waited_ = false;
    bool collecting_ = false; ///< within as_one, by a device that does
    std::uint64_t submissions_ = 0;
};

/// Books commands of its lifetime under a stage; an inner scope's stage stands until it ends. Dies before its
/// device. A profiler sees it as a range of that name.
class StageScope {
public:
    StageScope(Device& device, Stage stage);
    ~StageScope();
    StageScope(const StageScope&) = delete;
    StageScope& operator=(const StageScope&) = delete;

private:
    Device& device_;
    std::optional<Stage> before_;
};

/// Times host work that belongs to a stage; the only clock outside the device's commands. Does nothing where
/// clocks are off. `label` has to outlive it.
class HostWork {
public:
    HostWork(Device& device, Stage stage, std::string_view label);
    ~HostWork();
    HostWork(const HostWork&) = delete;
    HostWork& operator=(const HostWork&) = delete;

private:
    Device& device_;
    Stage stage_;
    bool timed_;
    std::string_view label_;
    std::chrono::steady_clock::time_point begin_;
};

/// The bytes of a vector's elements, to upload them.
template<class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
    return std::as_bytes(std::span(values));
}

} // namespace tandem
