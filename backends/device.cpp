// SPDX-License-Identifier: MIT
#include "backends/device.h"

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

/// Keeps the device's count of live bytes right, whoever drops the last handle.
std::shared_ptr<Buffer::Impl> counted(std::shared_ptr<Buffer::Impl> impl,
                                      const std::shared_ptr<std::size_t>& count) {
    *count += impl->bytes;
    auto* raw = impl.get();
    return {raw, [impl = std::move(impl), count](Buffer::Impl*) mutable {
                *count -= impl->bytes;
                impl.reset();
            }};
}

} // namespace

void Device::record(Event event, Clock::time_point begin) {
    event.stage = stage_;
    event.host_ns = nanoseconds_since(begin);
    trace_.events.push_back(std::move(event));
}

Buffer Device::allocate(std::size_t bytes, std::string_view label) {
    const auto& has = info();
    // Zero-sized buffers are not allowed by OpenCL; one word keeps callers free of special cases.
    const auto size = std::max<std::size_t>(bytes, 16);
    if (size > has.max_allocation)
        throw DeviceError(
            fmt::format("{} ({}): buffer '{}' needs {} bytes, and one allocation holds at most {}", has.id,
                        has.name, label, size, has.max_allocation));
    auto impl = do_allocate(size);
    impl->bytes = size;
    impl->label = label;
    return Buffer(counted(std::move(impl), allocated_));
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
    const auto begin = Clock::now();
    const auto ticket = do_upload(to.impl(), from, offset, blocking);
    record({.command = Command::upload,
            .stage = stage_,
            .label = to.impl().label,
            .bytes = from.size(),
            .ticket = ticket,
            .blocked = blocking},
           begin);
}

void Device::download(const Buffer& from, std::span<std::byte> to, std::size_t offset) {
    check_range(from, offset, to.size(), "download");
    if (to.empty()) return;
    const auto begin = Clock::now();
    const auto ticket = do_download(from.impl(), to, offset);
    record({.command = Command::download,
            .stage = stage_,
            .label = from.impl().label,
            .bytes = to.size(),
            .ticket = ticket,
            .blocked = true},
           begin);
}

void Device::clear(const Buffer& buffer, std::size_t bytes, std::size_t offset) {
    check_range(buffer, offset, bytes, "clear");
    if (bytes == 0) return;
    const auto begin = Clock::now();
    const auto ticket = do_clear(buffer.impl(), bytes, offset);
    record({.command = Command::clear,
            .stage = stage_,
            .label = buffer.impl().label,
            .bytes = bytes,
            .ticket = ticket},
           begin);
}

Kernel Device::compile(const KernelSource& source, std::string_view entry, const Defines& defines) {
    const auto key = kernel_key(source, entry, defines);
    if (const auto found = kernels_.find(key); found != kernels_.end()) {
        asked_.push_back(found->second.facts());
        asked_.back().compile_ms = 0;
        return found->second;
    }
    const auto begin = Clock::now();
    auto impl = do_compile(source, entry, defines);
    impl->facts.entry = entry;
    impl->facts.defines = defines;
    impl->facts.compile_ms = static_cast<double>(nanoseconds_since(begin)) * 1e-6;
    asked_.push_back(impl->facts);
    return kernels_.emplace(key, Kernel(std::move(impl))).first->second;
}

void Device::launch(const Kernel& kernel, Grid grid, std::span<const Argument> arguments) {
    if (grid.groups == 0) return;
    const auto begin = Clock::now();
    const auto ticket = do_launch(kernel.impl(), grid, arguments);
    record({.command = Command::launch,
            .stage = stage_,
            .label = kernel.facts().entry,
            .groups = grid.groups,
            .group_size = grid.group_size,
            .ticket = ticket},
           begin);
}

Trace Device::finish() {
    const auto begin = Clock::now();
    const bool pending = !trace_.events.empty() && !trace_.events.back().blocked;
    do_finish();
    if (pending)
        record({.command = Command::wait, .stage = stage_, .label = "finish", .blocked = true}, begin);
    for (auto& event : trace_.events)
        if (event.ticket != 0) std::tie(event.begin_ns, event.device_ns) = do_interval(event.ticket);
    return std::exchange(trace_, {});
}

Stage Device::set_stage(Stage stage) { return std::exchange(stage_, stage); }

void Device::set_clocks(Clocks clocks) {
    do_finish();
    do_set_clocks(clocks);
    clocks_ = clocks;
}

std::vector<KernelFacts> Device::take_kernels() { return std::exchange(asked_, {}); }

std::size_t Device::bytes_allocated() const { return *allocated_; }

HostWork::HostWork(Device& device, Stage stage, std::string_view label)
    : device_(device), stage_(stage), label_(label), begin_(Clock::now()) {}

HostWork::~HostWork() {
    const StageScope scope(device_, stage_);
    device_.record({.command = Command::host_work, .stage = stage_, .label = std::move(label_)}, begin_);
}

} // namespace tandem
