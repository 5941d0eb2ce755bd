// SPDX-License-Identifier: MIT
#include "backends/device.h"

#include "backends/buffer_guards.h"
#include "backends/ranges.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace tandem {

namespace {

using Clock = std::chrono::steady_clock;

std::int64_t nanoseconds_since(Clock::time_point begin) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
}

void check_range(const Buffer& buffer, std::size_t offset, std::size_t bytes, std::string_view what) {
    if (buffer && offset <= buffer.bytes() && bytes <= buffer.bytes() - offset) return;
    throw DeviceError(fmt::format("{} of {} bytes at {} exceeds buffer '{}' of {} bytes", what, bytes, offset,
                                  buffer ? buffer.impl().label : "(none)", buffer.bytes()));
}

std::string kernel_key(const KernelSource& source, std::string_view entry, const Defines& defines) {
    std::string key = fmt::format("{}|{}", source.name, entry);
    for (const auto& [name, value] : defines) key += fmt::format("|{}={}", name, value);
    return key;
}

/// Checked before the launch: a vendor's error code covers many mistakes and names no kernel.
void check_group_size(const DeviceInfo& device, const KernelFacts& kernel, std::uint32_t group_size) {
    const auto limit =
        kernel.max_group_size >= 0 ? kernel.max_group_size : std::int64_t{device.max_group_size};
    if (group_size > 0 && group_size <= limit) return;
    throw DeviceError(
        fmt::format("{} ({}): kernel '{}' cannot run in groups of {} work-items; the maximum is {}",
                    device.id, device.name, kernel.entry, group_size, limit));
}

[[noreturn]] void refuse_without_stage(const DeviceInfo& device, Command command, std::string_view label) {
    constexpr std::string_view names[] = {"launch", "upload", "download", "clear"};
    throw std::logic_error(fmt::format("{} ({}): {} of '{}' outside any StageScope; create one for its stage",
                                       device.id, device.name, names[static_cast<std::size_t>(command)],
                                       label));
}

/// Updates the device's count of allocated bytes, and its guards, when the last handle is dropped.
std::shared_ptr<Buffer::Impl> counted(std::shared_ptr<Buffer::Impl> impl,
                                      const std::shared_ptr<std::size_t>& count,
                                      const std::shared_ptr<BufferGuards>& guards) {
    *count += impl->bytes;
    auto* raw = impl.get();
    return {raw, [impl = std::move(impl), count, guards](Buffer::Impl*) mutable {
                *count -= impl->bytes;
                if (guards) guards->remove(*impl);
                impl.reset();
            }};
}

} // namespace

Device::Device() = default;

Device::~Device() {
    if (guards_) guards_->detach();
}

void Device::guard_buffers() {
    if (!guards_) guards_ = std::make_shared<BufferGuards>(*this);
}

void Device::fill_buffers(std::uint32_t word, std::span<const std::string_view> kept) {
    guard_buffers();
    guards_->fill(word, kept);
}

void Device::do_check_guards() { guards_->check(); }

void Device::record(Event event, Clock::time_point begin) {
    event.host_begin_ns =
        std::chrono::duration_cast<std::chrono::nanoseconds>(begin.time_since_epoch()).count();
    event.host_ns = nanoseconds_since(begin);
    trace_.events.push_back(std::move(event));
}

template<class Work>
void Device::submit(Event event, std::string_view label, const Work& work) {
    if (!stage_) refuse_without_stage(info(), event.command, label);
    if (!collecting_) ++submissions_;
    if (clocks_ == Clocks::off) {
        work();
        return;
    }
    event.stage = *stage_;
    waited_ = false;
    const auto begin = Clock::now();
    event.ticket = work();
    event.blocked |= waited_;
    event.label = label;
    record(std::move(event), begin);
}

void Device::check_capacity(std::size_t bytes, std::string_view label) const {
    const auto& device = info();
    const auto refuse = [&](std::string_view why, std::uint64_t limit) {
        throw OutOfMemory(fmt::format("{} ({}): buffer '{}' needs {} bytes, {} are in use, and {} {}",
                                      device.id, device.name, label, bytes, bytes_allocated(), why, limit));
    };
    const auto exceeds = [&](std::uint64_t limit) {
        return bytes_allocated() > limit || bytes > limit - bytes_allocated();
    };
    if (bytes > device.max_allocation)
        throw OutOfMemory(
            fmt::format("{} ({}): buffer '{}' needs {} bytes, and one allocation holds at most {}", device.id,
                        device.name, label, bytes, device.max_allocation));
    if (exceeds(memory_limit_)) refuse("the limit is", memory_limit_);
    if (device.allocates_late && exceeds(device.global_bytes)) refuse("the device has", device.global_bytes);
}

Buffer Device::allocate(std::size_t bytes, std::string_view label) {
    // OpenCL does not allow buffers of size zero; a minimum size saves callers a special case.
    const auto size = std::max<std::size_t>(bytes, 16);
    check_capacity(size, label);
    auto impl = do_allocate(guards_ ? size + BufferGuards::padding : size);
    impl->bytes = size;
    impl->label = label;
    if (guards_) guards_->add(*impl);
    return Buffer(counted(std::move(impl), allocated_, guards_));
}

Buffer Device::adopt(void* native, std::size_t bytes, std::string_view label) {
    auto impl = do_adopt(native);
    impl->bytes = bytes;
    impl->label = label;
    return Buffer(std::move(impl));
}

void Device::upload(const Buffer& to, std::span<const std::byte> from, std::size_t offset, bool blocking) {
    check_range(to, offset, from.size(), "upload");
    if (from.empty()) return;
    if (held_ != nullptr) held_->push_back(to);
    submit({.command = Command::upload, .bytes = from.size(), .blocked = blocking}, to.impl().label,
           [&] { return do_upload(to.impl(), from, offset, blocking); });
}

void Device::download(const Buffer& from, std::span<std::byte> to, std::size_t offset) {
    check_range(from, offset, to.size(), "download");
    if (to.empty()) return;
    submit({.command = Command::download, .bytes = to.size(), .blocked = true}, from.impl().label,
           [&] { return do_download(from.impl(), to, offset); });
}

void Device::clear(const Buffer& buffer, std::size_t bytes, std::size_t offset) {
    check_range(buffer, offset, bytes, "clear");
    if (bytes == 0) return;
    if (held_ != nullptr) held_->push_back(buffer);
    submit({.command = Command::clear, .bytes = bytes}, buffer.impl().label,
           [&] { return do_clear(buffer.impl(), bytes, offset); });
}

Kernel Device::compile(const KernelSource& source, std::string_view entry, const Defines& defines) {
    const auto key = kernel_key(source, entry, defines);
    auto found = kernels_.find(key);
    if (found == kernels_.end()) {
        const auto begin = Clock::now();
        auto impl = do_compile(source, entry, defines);
        impl->facts.entry = entry;
        impl->facts.defines = defines;
        impl->facts.compile_ms += static_cast<double>(nanoseconds_since(begin)) * 1e-6;
        found = kernels_.emplace(key, Compiled{Kernel(std::move(impl))}).first;
    }
    if (together_ > 0)
        incomplete_.push_back(&found->second);
    else
        complete(found->second);
    return found->second.kernel;
}

void Device::complete(Compiled& known) {
    known.kernel.impl().complete();
    if (!std::exchange(known.requested, true)) requested_.push_back(known.kernel.facts());
}

void Device::complete_kernels() {
    for (auto* known : std::exchange(incomplete_, {})) complete(*known);
}

void Device::launch(const Kernel& kernel, Grid grid, std::span<const Argument> arguments) {
    if (grid.groups == 0) return;
    if (check_) check_();
    if (together_ > 0) kernel.impl().complete();
    check_group_size(info(), kernel.facts(), grid.group_size);
    if (held_ != nullptr)
        for (const auto& argument : arguments)
            if (const auto* buffer = std::get_if<Buffer::Impl*>(&argument.value()))
                held_->emplace_back((*buffer)->shared_from_this());
    submit({.command = Command::launch,
            .groups = grid.groups,
            .group_size = grid.group_size,
            .kernel = &kernel.facts()},
           kernel.facts().entry, [&] { return do_launch(kernel.impl(), grid, arguments); });
}

Trace Device::finish() {
    if (clocks_ == Clocks::off) {
        do_finish();
        return {};
    }
    const auto begin = Clock::now();
    do_finish();
    // A wait counts only while work is in flight. Its stage is that of the last submitted command.
    const auto last = std::find_if(trace_.events.rbegin(), trace_.events.rend(), [](const Event& e) {
        return e.command != Command::host_work && e.command != Command::phase;
    });
    if (last != trace_.events.rend() && !last->blocked)
        record({.command = Command::wait, .stage = last->stage, .label = "finish", .blocked = true}, begin);
    read_times();
    return std::exchange(trace_, {});
}

/// Adaptors require that each ticket is released once, in ascending order.
void Device::read_times() {
    const auto guarding = guards_ ? guards_->take_tickets() : std::vector<std::uint64_t>{};
    auto next = guarding.begin();
    for (auto& event : trace_.events) {
        if (event.ticket == 0) continue;
        for (; next != guarding.end() && *next < event.ticket; ++next) do_interval(*next);
        std::tie(event.begin_ns, event.device_ns) = do_interval(event.ticket);
    }
    for (; next != guarding.end(); ++next) do_interval(*next);
}

void Device::set_clocks(Clocks clocks) {
    finish();
    do_set_clocks(clocks);
    clocks_ = clocks;
}

std::vector<KernelFacts> Device::take_kernels() {
    for (auto& [key, known] : kernels_) {
        known.requested = false;
        known.kernel.impl().facts.compile_ms = 0;
    }
    return std::exchange(requested_, {});
}

std::size_t Device::bytes_allocated() const { return *allocated_; }

StageScope::StageScope(Device& device, Stage stage) : device_(device), previous_(device.set_stage(stage)) {
    ranges::push(stage_names[static_cast<std::size_t>(stage)].data());
}

StageScope::~StageScope() {
    ranges::pop();
    device_.set_stage(previous_);
}

HostWork::HostWork(Device& device, Stage stage, std::string_view label)
    : device_(device), stage_(stage), timed_(device.clocks() == Clocks::on), label_(label) {
    if (timed_) begin_ = Clock::now();
}

HostWork::~HostWork() {
    if (!timed_ || device_.clocks() == Clocks::off) return;
    device_.record({.command = Command::host_work, .stage = stage_, .label = std::string(label_)}, begin_);
}

HostPhase::HostPhase(Device& device, std::string_view label)
    : device_(device), timed_(device.clocks() == Clocks::on), label_(label) {
    if (timed_) begin_ = Clock::now();
}

HostPhase::~HostPhase() {
    if (!timed_ || device_.clocks() == Clocks::off) return;
    device_.record({.command = Command::phase, .label = std::string(label_)}, begin_);
}

} // namespace tandem
