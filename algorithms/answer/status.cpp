// SPDX-License-Identifier: MIT
#include "algorithms/answer/status.h"

#include "algorithms/answer/wrench_sums.h"
#include "base/error.h"

#include <fmt/format.h>

namespace tandem {

namespace {

/// By number of the bound.
constexpr std::array<std::string_view, EXCEEDED_UNITS> bounds{
    "the queries of a body pair", "the node pairs in a queue", "the body pairs that have contacts"};

} // namespace

Status::Status(Device& device, Writes writes) : device_(device), writes_(writes) {
    buffer_ = device.allocate(sizeof(Words), "status");
}

void Status::put(std::size_t word, std::uint64_t value) {
    words_[word] = static_cast<std::uint32_t>(value);
    words_[word + 1] = static_cast<std::uint32_t>(value >> 32);
}

void Status::begin(std::uint64_t body_pairs) {
    words_.fill(0);
    put(STATUS_BODY_PAIRS, body_pairs);
    const StageScope scope(device_, Stage::write);
    if (body_pairs == 0)
        device_.clear(buffer_, sizeof(Words));
    else
        device_.upload(buffer_, std::as_bytes(std::span(words_)));
}

void Status::set(std::size_t word, std::uint64_t value) {
    put(word, value);
    write(words_);
}

void Status::set_window(std::uint32_t first, std::uint32_t end) {
    words_[STATUS_WINDOW_FIRST] = first;
    words_[STATUS_WINDOW_END] = end;
    write(words_);
}

void Status::write(const Words& words) {
    words_ = words;
    // Writes all words, because Oclgrind 21.10 treats the rest as uninitialised after a partial write.
    const StageScope scope(device_, Stage::write);
    device_.upload(buffer_, std::as_bytes(std::span(words_)), 0, writes_ == Writes::blocking);
}

void Status::read() {
    const StageScope scope(device_, Stage::read);
    device_.download(buffer_, std::as_writable_bytes(std::span(words_)));
    if (words_[STATUS_EXCEEDED + EXCEEDED_UNITS] != 0) throw InputError(std::string(wrench_too_large));
    for (std::size_t i = 0; i < bounds.size(); ++i)
        if (words_[STATUS_EXCEEDED + i] != 0)
            throw DeviceError(
                fmt::format("{}: a frame exceeds a bound that tandem has derived for {}, so that "
                            "its answer lacks pairs; this is an error of tandem: report it "
                            "with the scene and the settings",
                            device_.info().id, bounds[i]));
}

} // namespace tandem
