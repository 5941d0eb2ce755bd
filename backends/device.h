// SPDX-License-Identifier: MIT
#pragma once

#include "backends/handles.h"
#include "backends/trace.h"

#include <chrono>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace tandem {

class BufferGuards;

/// A device failed or cannot do what was requested. The message is one line: backend, call, code and
/// operation. Earlier commands are no longer in flight, or waiting for them is impossible.
struct DeviceError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Memory does not suffice; the message names the requested and the available bytes. Thrown by allocate(),
/// and by later commands where memory is taken at first use (DeviceInfo::allocates_late) or a kernel needs
/// its own. The device remains usable; freeing buffers helps.
struct OutOfMemory : DeviceError {
    using DeviceError::DeviceError;
};

/// Properties of a device; sizes in bytes.
struct DeviceInfo {
    std::string id;                     ///< "host", "opencl:0", "cuda:0"
    std::string name;                   ///< the vendor's name
    std::string driver;                 ///< driver or runtime version
    std::string compiler;               ///< the compiler of kernels
    std::string hardware;               ///< PCI address or UUID; empty when unknown
    bool is_gpu = false;                ///< false for CPUs and other kinds of accelerators
    std::uint32_t compute_units = 1;    ///< units that run work-groups in parallel: multiprocessors, cores
    std::uint32_t max_group_size = 1;   ///< work-items; a kernel's own limit may be lower
    std::uint32_t cores = 0;            ///< for float additions and multiplications, in total; 0: unknown
    std::uint32_t clock_mhz = 0;        ///< maximum; 0: unknown
    std::uint64_t peak_bytes_per_s = 0; ///< of memory, from its clock and width; 0: unknown
    std::uint64_t global_bytes = 0;     ///< total device memory, free or not
    std::uint64_t max_allocation = 0;   ///< largest size of one buffer
    std::uint64_t local_bytes = 0;      ///< local memory of a work-group
    bool allocates_late = false;        ///< memory is taken at first use, so allocate() counts it
    bool has_double = true;             ///< kernels can use double
    bool has_directed_rounding = false; ///< kernels can add with rounding down and up
    bool stages_pinned = false;         ///< non-blocking uploads use page-locked memory
    std::uint32_t compilers = 1;        ///< kernel files that are compiled at the same time
};

/// Whether commands are recorded, with device timestamps. When off, the default, no clock is read, no event
/// is created and no command is recorded.
enum class Clocks { off, on };

/// The most threads of a host device.
inline constexpr std::uint32_t most_threads = 4096;

/// One device of one backend. With clocks on, the public functions record each command in the trace, and
/// private virtual functions execute it. Thus every command is recorded exactly once.
/// A command (upload, download, clear, launch) belongs to a stage of a frame. Outside any StageScope it
/// throws std::logic_error that names it, with clocks on or off. Commands run in order. Only one thread at a
/// time may use a device; different devices may run in different threads. A thread's current CUDA context is
/// restored. Every function may throw DeviceError.
class Device {
public:
    virtual ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    /// Properties of the device; valid as long as the device.
    virtual const DeviceInfo& info() const = 0;
    /// The source of device times: "CUPTI 13.0 activity records", or "CUDA events" and why nothing better is
    /// used. It is certain only once clocks have been on, because they load a library of their own. A failure
    /// may change it while they are on.
    virtual std::string clock() const = 0;
    /// The vendor's handle of the queue of commands: a CUstream of CUDA, null for its default stream; a
    /// cl_command_queue of OpenCL; null on the host.
    virtual void* queue() const = 0;
    /// Later commands run after everything submitted so far to `queue`, a vendor's handle in this device's
    /// context. On OpenCL the host waits for it.
    void follow(void* queue) { do_follow(queue); }
    /// What is submitted to `queue` later runs after everything submitted so far here. On OpenCL the host
    /// waits for it.
    void precede(void* queue) { do_precede(queue); }
    /// Whether commands are now captured into a graph of the application, as cudaStreamBeginCapture() on the
    /// queue, or on one that it follows, begins. Such commands must not wait.
    bool is_captured() { return do_is_captured(); }

    /// Allocates at least `bytes` bytes of undefined values. Throws OutOfMemory that names the requested, the
    /// used and the available bytes.
    Buffer allocate(std::size_t bytes, std::string_view label);
    /// Wraps memory of a host application's context: a cl_mem or a device pointer, which must outlive the
    /// buffer. It does not count as allocated.
    Buffer adopt(void* native, std::size_t bytes, std::string_view label);

    /// Copies `from` to `to` at byte `offset`. Unless `blocking`, it returns once the bytes are copied to
    /// staging memory. That memory is limited; the call waits while uploads in flight fill it.
    void upload(const Buffer& to, std::span<const std::byte> from, std::size_t offset = 0,
                bool blocking = false);
    /// Copies from `from` at byte `offset` and waits for the result.
    void download(const Buffer& from, std::span<std::byte> to, std::size_t offset = 0);
    /// Sets `bytes` bytes at `offset` to zero.
    void clear(const Buffer& buffer, std::size_t bytes, std::size_t offset = 0);

    /// Compiles once per (source, entry, defines) and device. Throws DeviceError with the compiler's log in
    /// one line.
    Kernel compile(const KernelSource& source, std::string_view entry, const Defines& defines);
    /// Compiles the kernels that `work` requests at the same time, as far as DeviceInfo::compilers allows.
    /// They are complete when the outermost call returns; a launch within it waits for its kernel. Throws the
    /// first error of a compiler.
    template<class Work>
    void compile_together(const Work& work) {
        ++together_;
        try {
            work();
        } catch (...) {
            if (--together_ == 0) incomplete_.clear();
            throw;
        }
        if (--together_ == 0) complete_kernels();
    }
    /// Runs a kernel with its arguments in order; zero groups launch nothing. Throws DeviceError when the
    /// groups are larger than the kernel allows.
    void launch(const Kernel& kernel, Grid grid, std::span<const Argument> arguments);
    /// The same for a kernel of the project, with its arguments by name: `{.nodes = nodes_, .count = 3u}`.
    template<class Arguments>
    void launch(const KernelOf<Arguments>& kernel, Grid grid,
                const std::type_identity_t<Arguments>& arguments) {
        launch(kernel.untyped(), grid, arguments.in_order());
    }

    /// Runs `work` and submits its commands as one, if the device supports it and the same commands came
    /// before, as in successive frames. A command that waits ends one submission and begins the next.
    /// Otherwise, and with clocks on, commands are submitted one by one. `work` may throw; what it enqueued
    /// before is submitted. A later command or the end may report the error of an earlier command.
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

    /// From now on adds the buffers of commands, except of downloads, to `list`; null: no longer.
    void hold_buffers(std::vector<Buffer>* list) { held_ = list; }

    /// The number of submissions so far. Commands that as_one() submits together count once.
    std::uint64_t submissions() const { return submissions_; }

    /// Waits for everything submitted so far and returns its trace with device times; empty when clocks are
    /// off.
    Trace finish();

    /// Waits, discards the trace since the last finish(), then switches clocks on or off. On CUDA the last
    /// device to switch them off detaches a profiling library from the driver. No other thread may be in a
    /// driver call then (cuda/activity.h).
    void set_clocks(Clocks clocks);
    Clocks clocks() const { return clocks_; } ///< off in a new device

    /// Sets the number of threads that run the work-groups of a launch on the host; 0, the default: one per
    /// core. Results do not depend on it. Other devices ignore it. Throws InputError for more than
    /// most_threads.
    void set_threads(std::uint32_t threads) { do_set_threads(threads); }

    /// Each later launch first calls `check`, unless it is empty. What it throws ends the frame.
    void set_check(std::function<void()> check) { check_ = std::move(check); }

    /// Starts or stops an attached profiler; does nothing when the backend has no such call.
    void profile(bool on) { do_profile(on); }

    /// The facts of every kernel requested since the last call, each once; compile_ms is 0 for kernels
    /// compiled before. Not within compile_together().
    std::vector<KernelFacts> take_kernels();

    /// Bytes of all live buffers, without adopted ones.
    std::size_t bytes_allocated() const;
    /// From now on allocate() throws OutOfMemory when bytes_allocated() would exceed `bytes`. Existing
    /// buffers stay.
    void set_memory_limit(std::size_t bytes) { memory_limit_ = bytes; }
    /// no_memory_limit unless set.
    std::size_t memory_limit() const { return memory_limit_; }
    /// The value of memory_limit() when there is no limit.
    static constexpr std::size_t no_memory_limit = std::numeric_limits<std::size_t>::max();

    /// For tests. Writes a pattern (buffer_guards.h) behind each new buffer; traces do not change.
    void guard_buffers();
    /// For tests. Fills all buffers but those of uploaded() (upload.h) and those labelled as in `kept`, and
    /// later every new one, with `word`.
    void fill_buffers(std::uint32_t word, std::span<const std::string_view> kept);
    /// Waits, and throws std::logic_error when something was written past the end of a guarded buffer, also
    /// of one freed since the last call. Does nothing without guard_buffers().
    void check_guards() {
        if (guards_) do_check_guards();
    }

protected:
    Device();

    /// For an adaptor that collects commands: adds the calls that submitted them.
    void count_submissions(std::uint64_t calls) { submissions_ += calls; }
    /// For an adaptor whose command waits although it need not: the trace records the wait.
    void host_waited() { waited_ = true; }

private:
    friend class BufferGuards;
    friend class HostPhase;
    friend class HostWork;
    friend class StageScope;

    struct Compiled {
        Kernel kernel;
        bool requested = false; ///< it is in requested_
    };

    // Implemented by adaptors. A command returns the ticket of its timestamps, 0 when clocks are off. Ranges
    // and group sizes are already checked. Error texts are built only on failure.

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
    virtual void do_precede(void* queue) = 0;
    virtual bool do_is_captured() { return false; }
    /// From now on the adaptor may hold commands back until the end or until one that waits. False: it does
    /// not.
    virtual bool do_begin_collecting() { return false; }
    /// Submits the commands held back, and counts these submissions with count_submissions().
    virtual void do_end_collecting() {}
    virtual void do_set_clocks(Clocks clocks) = 0;
    virtual void do_set_threads(std::uint32_t) {}
    virtual void do_profile(bool) {}
    /// Begin and duration in device nanoseconds of a finished command; releases the ticket.
    virtual std::pair<std::int64_t, std::int64_t> do_interval(std::uint64_t ticket) = 0;

    void check_capacity(std::size_t bytes, std::string_view label) const;
    void do_check_guards();
    /// Fills in the device times of the trace and releases all tickets.
    void read_times();
    /// Runs `work`, which returns a ticket, and records it when clocks are on.
    template<class Work>
    void submit(Event event, std::string_view label, const Work& work);
    void record(Event event, std::chrono::steady_clock::time_point begin);
    std::optional<Stage> set_stage(std::optional<Stage> stage) { return std::exchange(stage_, stage); }

    void complete(Compiled& known);
    /// Waits for the compilers of compile_together().
    void complete_kernels();

    std::map<std::string, Compiled> kernels_;
    std::vector<KernelFacts> requested_;
    int together_ = 0;                  ///< nested calls of compile_together()
    std::vector<Compiled*> incomplete_; ///< requested within them
    std::shared_ptr<std::size_t> allocated_ = std::make_shared<std::size_t>(0);
    std::size_t memory_limit_ = no_memory_limit;
    std::shared_ptr<BufferGuards> guards_; ///< null without guard_buffers()
    Trace trace_;
    std::optional<Stage> stage_; ///< none outside any StageScope
    Clocks clocks_ = Clocks::off;
    bool waited_ = false;
    bool collecting_ = false; ///< within as_one(), on a device that collects
    std::function<void()> check_;
    std::vector<Buffer>* held_ = nullptr; ///< null without hold_buffers()
    std::uint64_t submissions_ = 0;
};

/// Device::compile_together() of several devices.
template<class Work>
void compile_together(std::span<Device* const> devices, const Work& work) {
    if (devices.empty())
        work();
    else
        devices.front()->compile_together([&] { compile_together(devices.subspan(1), work); });
}

/// Assigns the commands of its lifetime to a stage; an inner scope takes precedence until it ends. Must end
/// before its device does. A profiler shows it as a range of that name.
class StageScope {
public:
    /// Makes `stage` the current stage of `device` until the destructor restores the previous one.
    StageScope(Device& device, Stage stage);
    ~StageScope();
    StageScope(const StageScope&) = delete;
    StageScope& operator=(const StageScope&) = delete;

private:
    Device& device_;
    std::optional<Stage> previous_;
};

/// Times host work that belongs to a stage; the only clock outside the device's commands. Does nothing when
/// clocks are off. `label` must outlive it.
class HostWork {
public:
    /// Starts the clock. The destructor stops it and adds an Event to the trace of `device`.
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

/// Times a part of a frame, such as those that the paper's release times: by the host's clock, all commands,
/// waits and host work in it included. Its time belongs to no stage. `label` must outlive it.
class HostPhase {
public:
    HostPhase(Device& device, std::string_view label);
    ~HostPhase();
    HostPhase(const HostPhase&) = delete;
    HostPhase& operator=(const HostPhase&) = delete;

private:
    Device& device_;
    bool timed_;
    std::string_view label_;
    std::chrono::steady_clock::time_point begin_;
};

/// The elements of a vector as bytes, for uploads.
template<class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
    return std::as_bytes(std::span(values));
}

} // namespace tandem
