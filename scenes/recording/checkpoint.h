// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tandem {

/// State from which a killed simulation resumes.
struct Checkpoint {
    std::uint64_t step = 0;   ///< completed steps
    std::uint64_t frames = 0; ///< frames of the recording at this step
    std::vector<std::byte> state;
};

/// Path of the checkpoint of the recording at `path`: PATH.checkpoint.
std::string checkpoint_path(const std::string& path);

/// Writes the checkpoint of a recording atomically: a crash leaves the complete old or new one. Throws
/// InputError.
void write_checkpoint(const std::string& path, std::uint64_t scene_digest, std::uint64_t step,
                      std::uint64_t frames, std::span<const std::byte> state);

/// The checkpoint of a recording; none when the file does not exist. Throws InputError when it is damaged,
/// has another version, or belongs to a scene with another digest.
std::optional<Checkpoint> read_checkpoint(const std::string& path, std::uint64_t scene_digest);

} // namespace tandem
