// SPDX-License-Identifier: MIT
#include "backends/buffer_guards.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Bytes that differ from their neighbours and are neither zeros nor small numbers, which kernels write.
constexpr std::array<std::byte, BufferGuards::bytes> make_pattern() {
    std::array<std::byte, BufferGuards::bytes> pattern{};
    for (std::size_t i = 0; i < pattern.size(); ++i) pattern[i] = static_cast<std::byte>(0xa5 ^ (i * 37));
    return pattern;
}

constexpr auto pattern = make_pattern();

} // namespace

void BufferGuards::add(Buffer::Impl& buffer) {
    keep(device_->do_upload(buffer, pattern, buffer.bytes, false));
    buffers_.push_back(&buffer);
}

void BufferGuards::check(Buffer::Impl& buffer) {
    keep(device_->do_download(buffer, found_, buffer.bytes));
    const auto differing = std::ranges::mismatch(found_, pattern).in1;
    if (differing == found_.end()) return;
    if (overwritten_.empty())
        overwritten_ =
            fmt::format("{}: a kernel wrote past the end of buffer '{}': byte {} behind its {} "
                        "bytes has changed",
                        device_->info().id, buffer.label, differing - found_.begin(), buffer.bytes);
    keep(device_->do_upload(buffer, pattern, buffer.bytes, false));
}

void BufferGuards::remove(Buffer::Impl& buffer) noexcept {
    std::erase(buffers_, &buffer);
    if (device_ == nullptr) return;
    try {
        check(buffer);
    } catch (const std::exception&) {} // freeing never fails; a device that cannot copy says so elsewhere
}

void BufferGuards::check() {
    for (auto* buffer : buffers_) check(*buffer);
    if (!overwritten_.empty()) throw std::logic_error(std::exchange(overwritten_, {}));
}

} // namespace tandem
