// SPDX-License-Identifier: MIT
#include "backends/described_device.h"

namespace tandem {

namespace {

class DescribedDevice final : public Device {
public:
    explicit DescribedDevice(DeviceInfo info) : info_(std::move(info)) {}

    const DeviceInfo& info() const override { return info_; }
    std::string clock() const override { return "unknown"; }
    void* queue() const override { return nullptr; }

private:
    using Ticket = std::uint64_t;

    [[noreturn]] void refuse() const {
        throw std::logic_error(info_.id + " is described, not opened: another process has it");
    }

    std::shared_ptr<Buffer::Impl> do_allocate(std::size_t) override { refuse(); }
    std::shared_ptr<Buffer::Impl> do_adopt(void*) override { refuse(); }
    Ticket do_upload(Buffer::Impl&, std::span<const std::byte>, std::size_t, bool) override { refuse(); }
    Ticket do_download(const Buffer::Impl&, std::span<std::byte>, std::size_t) override { refuse(); }
    Ticket do_clear(Buffer::Impl&, std::size_t, std::size_t) override { refuse(); }
    std::shared_ptr<Kernel::Impl> do_compile(const KernelSource&, std::string_view, const Defines&) override {
        refuse();
    }
    Ticket do_launch(Kernel::Impl&, Grid, std::span<const Argument>) override { refuse(); }
    void do_finish() override { refuse(); }
    void do_follow(void*) override { refuse(); }
    void do_set_clocks(Clocks) override { refuse(); }
    std::pair<std::int64_t, std::int64_t> do_interval(Ticket) override { refuse(); }

    DeviceInfo info_;
};

} // namespace

std::unique_ptr<Device> described_device(DeviceInfo info) {
    return std::make_unique<DescribedDevice>(std::move(info));
}

} // namespace tandem
