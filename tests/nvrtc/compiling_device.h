// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/nvrtc.h"

#include <set>

namespace tandem {

/// A device that only compiles: a session prepared on it requests exactly the kernels of its cell. It has no
/// memory, and its commands do nothing.
class CompilingDevice : public Device {
public:
    explicit CompilingDevice(std::uint32_t compilers = 1) {
        info_.compilers = compilers;
        info_.id = "nvrtc";
        info_.name = "a GPU that is not there";
        info_.is_gpu = true;
        info_.compute_units = 132;
        info_.max_group_size = 1024;
        info_.global_bytes = info_.max_allocation = std::uint64_t{1} << 40;
        info_.local_bytes = 49152;
        info_.has_directed_rounding = true;
    }
    explicit CompilingDevice(DeviceInfo info) : info_(std::move(info)) {}

    /// Every requested (file, defines), with its kernel entries.
    const std::map<std::pair<std::string, Defines>, std::set<std::string>>& requested() const {
        return requested_;
    }
    const DeviceInfo& info() const override { return info_; }
    std::string clock() const override { return "none"; }
    void* queue() const override { return nullptr; }

private:
    struct Nothing : Buffer::Impl {
        void* native() const override { return nullptr; }
    };
    struct NoKernel : Kernel::Impl {};

    std::shared_ptr<Buffer::Impl> do_allocate(std::size_t) override { return std::make_shared<Nothing>(); }
    std::shared_ptr<Buffer::Impl> do_adopt(void*) override { return std::make_shared<Nothing>(); }
    std::uint64_t do_upload(Buffer::Impl&, std::span<const std::byte>, std::size_t, bool) override {
        return 0;
    }
    std::uint64_t do_download(const Buffer::Impl&, std::span<std::byte> to, std::size_t) override {
        std::fill(to.begin(), to.end(), std::byte{0});
        return 0;
    }
    std::uint64_t do_clear(Buffer::Impl&, std::size_t, std::size_t) override { return 0; }
    std::shared_ptr<Kernel::Impl> do_compile(const KernelSource& source, std::string_view entry,
                                             const Defines& defines) override {
        requested_[{std::string(source.name), defines}].insert(std::string(entry));
        return std::make_shared<NoKernel>();
    }
    std::uint64_t do_launch(Kernel::Impl&, Grid, std::span<const Argument>) override { return 0; }
    void do_finish() override {}
    void do_follow(void*) override {}
    void do_precede(void*) override {}
    void do_set_clocks(Clocks) override {}
    std::pair<std::int64_t, std::int64_t> do_interval(std::uint64_t) override { return {-1, -1}; }

    DeviceInfo info_;
    std::map<std::pair<std::string, Defines>, std::set<std::string>> requested_;
};

} // namespace tandem
