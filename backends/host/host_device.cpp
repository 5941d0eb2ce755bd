// SPDX-License-Identifier: MIT
#include "backends/host/host_device.h"

#include "backends/host/dialect.h"

#include <fmt/format.h>
#include <algorithm>
#include <new>
#include <stdexcept>
#include <thread>
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

DeviceInfo describe() {
    DeviceInfo info;
    info.id = "host";
    info.name = "host C++";
    info.driver = "none";
    info.compiler = fmt::format("g++ {}", __VERSION__);
    info.global_bytes = physical_memory();
    info.max_allocation = info.global_bytes / 2;
    info.local_bytes = 1u << 20;
    return info;
}

class HostDevice : public Device {
public:
    const DeviceInfo& info() const override { return info_; }

private:
    using Clock = std::chrono::steady_clock;

    std::shared_ptr<Buffer::Impl> do_allocate(std::size_t bytes) override {
        auto buffer = std::make_shared<HostBuffer>();
        try {
            buffer->storage.resize(bytes);
        } catch (const std::bad_alloc&) {
            refuse(bytes);
        } catch (const std::length_error&) {
            refuse(bytes);
        }
        buffer->data = buffer->storage.data();
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
        for (const auto& [set, value] : impl.runtime) set(value);
        return timed([&] {
            group_count = static_cast<uint>(grid.groups);
            for (group_id = 0; group_id < group_count; ++group_id) impl.row->run(arguments);
        });
    }

    void do_finish() override {}
    void do_set_clocks(Clocks) override {}

    std::pair<std::int64_t, std::int64_t> do_interval(std::uint64_t ticket) override {
        const auto interval = intervals_.at(ticket - 1);
        if (ticket == intervals_.size()) intervals_.clear();
        return interval;
    }

    [[noreturn]] void refuse(std::size_t bytes) const {
        throw OutOfMemory(fmt::format("host: {} bytes asked for, {} in use, and the machine has {}", bytes,
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

    DeviceInfo info_ = describe();
    std::vector<std::pair<std::int64_t, std::int64_t>> intervals_;
};

/// Splits the defines into the compiled ones, as text, and the rest.
std::pair<std::string, Defines> split(const Defines& defines) {
    std::string fixed;
    Defines rest;
    for (const auto& [name, value] : defines) {
        if (name == "K" || name == "AXES" || name == "PRECISION")
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

const HostKernel* find_row(std::string_view source, std::string_view entry, std::string_view fixed) {
    for (const auto& variant : known_variants())
        for (const auto& row : variant)
            if (row.source == source && row.entry == entry && row.defines == fixed) return &row;
    return nullptr;
}

std::shared_ptr<Kernel::Impl> HostDevice::do_compile(const KernelSource& source, std::string_view entry,
                                                     const Defines& defines) {
    const auto [fixed, rest] = split(defines);
    const auto* row = find_row(source.name, entry, fixed);
    if (!row)
        throw DeviceError(
            fmt::format("host: kernel '{}' of {} is not compiled for {}; the host has the K that setting k "
                        "lists, in PRECISION 32 and 64",
                        entry, source.name, fixed));
    auto impl = std::make_shared<HostKernelImpl>();
    impl->row = row;
    for (const auto& define : row->runtime) impl->runtime.emplace_back(define.set, define.initial);
    for (const auto& [name, value] : rest) {
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

std::unique_ptr<Device> make_device() { return std::make_unique<HostDevice>(); }

} // namespace tandem::host
