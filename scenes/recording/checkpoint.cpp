// SPDX-License-Identifier: MIT
#include "scenes/recording/checkpoint.h"

#include "base/error.h"
#include "scenes/read/cursor.h"
#include "scenes/recording/bytes.h"
#include "scenes/recording/file.h"

#include <filesystem>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr std::string_view magic("\x89TDMCP\r\n", 8);
constexpr std::uint32_t version = 1;
/// Size of magic, version, digest, step, frames and size: 8 + 4 + 4 * 8.
constexpr std::size_t bytes_before_state = 44;

} // namespace

std::string checkpoint_path(const std::string& path) { return path + ".checkpoint"; }

void write_checkpoint(const std::string& path, std::uint64_t scene_digest, std::uint64_t step,
                      std::uint64_t frames, std::span<const std::byte> state) {
    std::string out(magic);
    recording::put(out, version);
    recording::put(out, scene_digest);
    recording::put(out, step);
    recording::put(out, frames);
    recording::put(out, std::uint64_t{state.size()});
    out.append(reinterpret_cast<const char*>(state.data()), state.size());
    recording::replace_whole(checkpoint_path(path), recording::sealed(std::move(out)));
}

std::optional<Checkpoint> read_checkpoint(const std::string& path, std::uint64_t scene_digest) {
    const auto name = checkpoint_path(path);
    if (!std::filesystem::exists(name)) return std::nullopt;
    const auto bytes = recording::read_whole(name);
    const auto fail = [&](std::string_view what) { throw InputError(fmt::format("{}: {}", name, what)); };
    if (!bytes.starts_with(magic)) fail("is not a checkpoint of a recording; record again");
    read::Cursor in(bytes, name, magic.size());
    if (const auto found = in.get<std::uint32_t>("version"); found != version)
        fail(fmt::format("has version {} of the format, this program reads version {}; record again", found,
                         version));
    if (bytes.size() < bytes_before_state + sizeof(std::uint32_t)) fail("is cut off; record again");
    const auto body = std::string_view(bytes).substr(0, bytes.size() - sizeof(std::uint32_t));
    if (read::Cursor(bytes, name, body.size()).get<std::uint32_t>("checksum") != recording::checksum(body))
        fail("does not match its checksum; record again");
    if (const auto found = in.get<std::uint64_t>("digest"); found != scene_digest)
        fail(fmt::format(
            "is of a scene with digest {:016x}, not {:016x}; resume with the scene it was begun with", found,
            scene_digest));
    Checkpoint checkpoint;
    checkpoint.step = in.get<std::uint64_t>("step");
    checkpoint.frames = in.get<std::uint64_t>("frames");
    const auto size = in.get<std::uint64_t>("size");
    if (size != body.size() - bytes_before_state)
        fail("does not contain the state it announces; record again");
    const auto* state = reinterpret_cast<const std::byte*>(body.data() + bytes_before_state);
    checkpoint.state.assign(state, state + size);
    return checkpoint;
}

} // namespace tandem
