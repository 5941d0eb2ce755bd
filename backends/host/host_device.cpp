// SPDX-License-Identifier: MIT
#include "backends/host/host_device.h"

#include "backends/host/dialect.h"
#include "base/error.h"
#include "base/fork_join.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <new>
#include <optional>
#include <set>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <unistd.h>

namespace tandem::host {

namespace {

struct HostKernelImpl : Kernel::Impl {
    const HostKernel* row = nullptr;
    std::vector<std::pair<void (*)(long), long>> runtime; ///< setters and values, applied before every launch
};

std::uint64_t physical_memory() {
    return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES))
           * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
}

/// The processor's level of x86-64: 2, 3 or 4; 0 below it and on other architectures.
int processor_level() {
#if defined(__x86_64__) && defined(__clang__)
    // Older clang does not accept the names of levels, so the features that separate them are tested.
    if (!__builtin_cpu_supports("sse4.2") || !__builtin_cpu_supports("popcnt")) return 0;
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !__builtin_cpu_supports("bmi2"))
        return 2;
    return __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd")
                   && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")
               ? 4
               : 3;
#elif defined(__x86_64__)
    return __builtin_cpu_supports("x86-64-v4")   ? 4
           : __builtin_cpu_supports("x86-64-v3") ? 3
           : __builtin_cpu_supports("x86-64-v2") ? 2
                                                 : 0;
#else
    return 0;
#endif
}

DeviceInfo describe(int level) {
    DeviceInfo info;
    info.id = "host";
    info.name = "host C++";
    info.driver = "none";
    info.compiler = fmt::format("g++ {}", __VERSION__);
    if (level != 0) info.compiler += fmt::format(", lanes for x86-64-v{}", level);
    info.global_bytes = physical_memory();
    info.max_allocation = info.global_bytes / 2;
    info.allocates_late = true;
    info.local_bytes = 1u << 20;
    info.compute_units = static_cast<std::uint32_t>(tbb::info::default_concurrency());
    return info;
}

class HostDevice : public Device {
public:
    explicit HostDevice(int level) : level_(level) {}

    const DeviceInfo& info() const override { return info_; }
    std::string clock() const override { return "steady clock"; }
    void* queue() const override { return nullptr; }

private:
    using Clock = std::chrono::steady_clock;

    std::shared_ptr<Buffer::Impl> do_allocate(std::size_t bytes) override {
        auto buffer = std::make_shared<HostBuffer>();
        try {
            // Uninitialised: capacities are larger than most frames need, and pages are mapped at first use.
            buffer->storage = std::make_unique_for_overwrite<std::byte[]>(bytes);
        } catch (const std::bad_alloc&) {
            refuse(bytes);
        }
        buffer->data = buffer->storage.get();
        return buffer;
    }

    std::shared_ptr<Buffer::Impl> do_adopt(void* native) override {
        auto buffer = std::make_shared<HostBuffer>();
        buffer->data = static_cast<std::byte*>(native);
        return buffer;
    }

    std::uint64_t do_upload(Buffer::Impl& to, std::span<const std::byte> from, std::size_t offset,
                            bool) override {
        return timed(
            [&] { std::memcpy(static_cast<HostBuffer&>(to).data + offset, from.data(), from.size()); });
    }

    std::uint64_t do_download(const Buffer::Impl& from, std::span<std::byte> to,
                              std::size_t offset) override {
        return timed(
            [&] { std::memcpy(to.data(), static_cast<const HostBuffer&>(from).data + offset, to.size()); });
    }

    std::uint64_t do_clear(Buffer::Impl& buffer, std::size_t bytes, std::size_t offset) override {
        return timed([&] { std::memset(static_cast<HostBuffer&>(buffer).data + offset, 0, bytes); });
    }

    std::shared_ptr<Kernel::Impl> do_compile(const KernelSource& source, std::string_view entry,
                                             const Defines& defines) override;

    std::uint64_t do_launch(Kernel::Impl& kernel, Grid grid, std::span<const Argument> arguments) override {
        const auto& impl = static_cast<HostKernelImpl&>(kernel);
        if (arguments.size() != impl.row->argument_count)
            throw DeviceError(fmt::format("host: kernel '{}' takes {} arguments, got {}", impl.row->entry,
                                          impl.row->argument_count, arguments.size()));
        return timed([&] {
            const auto begun = run_serially(impl, grid.groups, arguments);
            if (begun == grid.groups) return;
            ForkJoin edges;
            const auto work = [&](const Groups& groups) {
                const ForkJoin::Part part(edges);
                run_groups(impl, grid.groups, groups, arguments, true);
            };
            arena_.execute([&] { tbb::parallel_for(Groups(begun, grid.groups), SynchronizedWork(work)); });
        });
    }

    using Groups = tbb::blocked_range<std::uint64_t>;

    /// Runs some groups of a launch in order on the calling thread.
    static void run_groups(const HostKernelImpl& kernel, std::uint64_t count, const Groups& groups,
                           std::span<const Argument> arguments, bool parallel) {
        for (const auto& [set, value] : kernel.runtime) set(value);
        group_count = static_cast<uint>(count);
        in_parallel = parallel;
        for (auto group = groups.begin(); group != groups.end(); ++group) {
            group_id = static_cast<uint>(group);
            kernel.row->run(arguments);
        }
    }

    /// Runs the first groups of a launch on the calling thread and returns how many. Runs all of them with
    /// one thread, or when they take less time than waking other threads.
    std::uint64_t run_serially(const HostKernelImpl& kernel, std::uint64_t count,
                               std::span<const Argument> arguments) const {
        constexpr auto wake_time = std::chrono::microseconds(50);
        const auto step = threads() == 1 ? count : std::max<std::uint64_t>(1, count / 256);
        const auto begin = Clock::now();
        std::uint64_t done = 0;
        while (done < count && (done == 0 || Clock::now() - begin < wake_time)) {
            const auto next = std::min(done + step, count);
            run_groups(kernel, count, {done, next}, arguments, false);
            done = next;
        }
        return done;
    }

    int threads() const { return arena_.max_concurrency(); }

    void do_set_threads(std::uint32_t threads) override {
        if (threads > most_threads)
            throw InputError(
                fmt::format("host: {} threads are more than {}; give fewer", threads, most_threads));
        const auto wanted = threads == 0 ? tbb::info::default_concurrency() : static_cast<int>(threads);
        if (wanted == this->threads()) return;
        arena_.terminate();
        // More threads than cores may be requested. Without this control oneTBB does not provide them, and
        // warns.
        thread_limit_.reset();
        if (wanted > tbb::info::default_concurrency())
            thread_limit_.emplace(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(wanted));
        arena_.initialize(wanted);
    }

    void do_follow(void*) override {} // every call completes before it returns
    void do_precede(void*) override {}
    void do_finish() override {}
    void do_set_clocks(Clocks) override {}

    std::pair<std::int64_t, std::int64_t> do_interval(std::uint64_t ticket) override {
        const auto interval = intervals_.at(ticket - 1);
        if (ticket == intervals_.size()) intervals_.clear();
        return interval;
    }

    [[noreturn]] void refuse(std::size_t bytes) const {
        throw OutOfMemory(fmt::format("host: {} bytes requested, {} in use, and the machine has {}", bytes,
                                      bytes_allocated(), info_.global_bytes));
    }

    template<class Work>
    std::uint64_t timed(Work work) {
        if (clocks() == Clocks::off) {
            work();
            return 0;
        }
        const auto begin = Clock::now();
        work();
        const auto ns = [](auto span) {
            return std::chrono::duration_cast<std::chrono::nanoseconds>(span).count();
        };
        intervals_.emplace_back(ns(begin.time_since_epoch()), ns(Clock::now() - begin));
        return intervals_.size();
    }

    int level_; ///< of the instructions that kernels may use
    DeviceInfo info_ = describe(level_);
    std::optional<tbb::global_control> thread_limit_;
    tbb::task_arena arena_{tbb::info::default_concurrency()};
    std::vector<std::pair<std::int64_t, std::int64_t>> intervals_;
};

/// Splits the defines into the compiled ones, as text, and the rest. PRESSURE_SLAB goes with K, and is 0
/// where it is left out.
std::pair<std::string, Defines> split(Defines defines) {
    if (defines.contains("K")) defines.emplace("PRESSURE_SLAB", "0");
    std::string fixed;
    Defines rest;
    for (const auto& [name, value] : defines) {
        if (name == "K" || name == "AXES" || name == "PRECISION" || name == "PRESSURE_SLAB"
            || name == "SLABS")
            fixed += fmt::format("{}{}={}", fixed.empty() ? "" : ";", name, value);
        else
            rest[name] = value;
    }
    return {fixed, rest};
}

std::vector<std::span<const HostKernel>>& known_variants() {
    static std::vector<std::span<const HostKernel>> all(host_kernels().begin(), host_kernels().end());
    return all;
}

bool is_constant(const HostKernel& row, std::string_view name) {
    return row.constants.find(fmt::format("{}=", name)) != std::string_view::npos;
}

/// Whether the defines that are constants in the kernel have these values.
bool has_constants(const HostKernel& row, const Defines& defines) {
    return std::all_of(defines.begin(), defines.end(), [&](const auto& define) {
        const auto& [name, value] = define;
        return !is_constant(row, name)
               || row.constants.find(fmt::format("{}={};", name, value)) != std::string_view::npos;
    });
}

/// The kernel with the highest level that the device may use, and of these the one with most constants.
const HostKernel* find_row(std::string_view source, std::string_view entry, std::string_view fixed,
                           const Defines& rest, int level) {
    const HostKernel* best = nullptr;
    const auto rank = [](const HostKernel& row) { return std::pair(row.level, row.constants.size()); };
    for (const auto& variant : known_variants())
        for (const auto& row : variant)
            if (row.source == source && row.entry == entry && row.defines == fixed && row.level <= level
                && has_constants(row, rest) && (!best || rank(row) > rank(*best)))
                best = &row;
    return best;
}

/// The values of setting k that kernels are compiled for. With a slab of pressures, K counts two more.
std::set<int> compiled_k() {
    constexpr std::string_view name = "K=";
    std::set<int> values;
    for (const auto& variant : known_variants())
        for (const auto& row : variant) {
            const std::string_view defines = row.defines;
            const auto at = defines.find(name);
            if (at != std::string_view::npos && defines.find("PRESSURE_SLAB=1") == std::string_view::npos)
                values.insert(std::stoi(std::string(defines.substr(at + name.size()))));
        }
    return values;
}

std::shared_ptr<Kernel::Impl> HostDevice::do_compile(const KernelSource& source, std::string_view entry,
                                                     const Defines& defines) {
    const auto [fixed, rest] = split(defines);
    const auto* row = find_row(source.name, entry, fixed, rest, level_);
    if (!row)
        throw DeviceError(fmt::format(
            "host: kernel '{}' of {} is not compiled for {}; this build has k = {}; build with an empty "
            "TANDEM_HOST_K for every k: scripts/build, or pip install . "
            "--config-settings=cmake.define.TANDEM_HOST_K=",
            entry, source.name, fixed, fmt::join(compiled_k(), ", ")));
    auto impl = std::make_shared<HostKernelImpl>();
    impl->row = row;
    for (const auto& define : row->runtime) impl->runtime.emplace_back(define.set, define.initial);
    for (const auto& [name, value] : rest) {
        if (is_constant(*row, name)) continue;
        if (name == "GROUP_SIZE") {
            if (value != "1")
                throw DeviceError("host: groups have one work-item; set group_size=1 or leave it out");
            continue;
        }
        const auto runtime = std::find_if(row->runtime.begin(), row->runtime.end(),
                                          [&name = name](const auto& d) { return d.name == name; });
        if (runtime == row->runtime.end())
            throw DeviceError(fmt::format("host: kernel '{}' has no parameter '{}'", entry, name));
        impl->runtime[static_cast<std::size_t>(runtime - row->runtime.begin())].second = std::stol(value);
    }
    return impl;
}

} // namespace

void add_host_kernels(std::span<const std::span<const HostKernel>> variants) {
    known_variants().insert(known_variants().end(), variants.begin(), variants.end());
}

std::set<int> compiled_levels() {
    std::set<int> levels;
    for (const auto& variant : known_variants())
        for (const auto& row : variant)
            if (row.level != 0) levels.insert(row.level);
    return levels;
}

std::unique_ptr<Device> make_device(int max_level) {
    const auto levels = compiled_levels();
    if (levels.empty()) return std::make_unique<HostDevice>(0);
    const int level = std::min(max_level, processor_level());
    const auto above = levels.upper_bound(level);
    if (above == levels.begin())
        throw DeviceError(fmt::format(
            "host: its kernels are compiled for x86-64-v{} and the available level is {}; build with "
            "-DTANDEM_LEVELS=\"2;3;4\" for any processor",
            *above, level));
    return std::make_unique<HostDevice>(*std::prev(above));
}

BackendReport discover() {
    BackendReport report;
    report.devices.push_back(make_device());
    return report;
}

} // namespace tandem::host
