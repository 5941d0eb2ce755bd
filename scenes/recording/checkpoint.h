// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tandem {

/// From where a killed simulation goes on.
struct Checkpoint {
    std::uint64_t step = 0;   ///< steps done
    std::uint64_t frames = 0; ///< of the recording up to it
    std::vector<std::byte> state;
};

/// The checkpoint of the recording at `path`: PATH.checkpoint.
std::string checkpoint_path(const std::string& path);

/// Writes the checkpoint of a recording; a crash at any moment leaves the old or the new one, whole. Throws
/// InputError.
void write_checkpoint(const std::string& path, std::uint64_t scene_digest, std::uint64_t step,
                      std::uint64_t frames, std::span<const std::byte> state);

/// The checkpoint of a recording; none when there is no such file. Throws InputError when it is damaged, of
/// another version, or of a scene with another digest.
std::optional<Checkpoint> read_checkpoint(const std::string& path, std::uint64_t scene_digest);

} // namespace tandem
