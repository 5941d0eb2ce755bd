// SPDX-License-Identifier: MIT
#include "backends/buffer_guards.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Bytes that differ from their neighbours and are no zeros or small numbers, because kernels write these.
constexpr std::array<std::byte, BufferGuards::bytes> make_pattern() {
    std::array<std::byte, BufferGuards::bytes> pattern{};
    for (std::size_t i = 0; i < pattern.size(); ++i) pattern[i] = static_cast<std::byte>(0xa5 ^ (i * 37));
    return pattern;
}

constexpr auto pattern = make_pattern();
constexpr std::size_t fill_words = std::size_t{1} << 18; ///< of an upload that fills a buffer

} // namespace

void BufferGuards::add(Buffer::Impl& buffer) {
    add_ticket(device_->do_upload(buffer, pattern, buffer.bytes, false));
    buffers_.push_back(&buffer);
    fill(buffer);
}

void BufferGuards::fill(Buffer::Impl& buffer) {
    const auto words = std::as_bytes(std::span(filling_));
    for (std::size_t at = 0; at < buffer.bytes && !words.empty(); at += words.size())
        add_ticket(
            device_->do_upload(buffer, words.first(std::min(words.size(), buffer.bytes - at)), at, false));
}

void BufferGuards::fill(std::uint32_t word, std::span<const std::string_view> kept) {
    filling_.assign(fill_words, word);
    for (auto* buffer : buffers_)
        if (!buffer->is_table && std::ranges::find(kept, buffer->label) == kept.end()) fill(*buffer);
}

void BufferGuards::check(Buffer::Impl& buffer) {
    add_ticket(device_->do_download(buffer, read_back_, buffer.bytes));
    const auto differing = std::ranges::mismatch(read_back_, pattern).in1;
    if (differing == read_back_.end()) return;
    if (overwritten_.empty())
        overwritten_ =
            fmt::format("{}: a kernel wrote past the end of buffer '{}': byte {} behind its {} "
                        "bytes has changed",
                        device_->info().id, buffer.label, differing - read_back_.begin(), buffer.bytes);
    add_ticket(device_->do_upload(buffer, pattern, buffer.bytes, false));
}

void BufferGuards::remove(Buffer::Impl& buffer) noexcept {
    std::erase(buffers_, &buffer);
    if (device_ == nullptr) return;
    try {
        check(buffer);
    } catch (const std::exception&) {} // freeing never fails; other calls report a failed device
}

void BufferGuards::check() {
    for (auto* buffer : buffers_) check(*buffer);
    if (!overwritten_.empty()) throw std::logic_error(std::exchange(overwritten_, {}));
}

} // namespace tandem
