// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace tandem::cuda {

/// The result of a compilation.
struct Image {
    std::string bytes;  ///< CUBIN or PTX, ready to be loaded as a module
    std::string target; ///< "sm_90 cubin" or "compute_90 ptx"
    std::string log;

    bool operator==(const Image&) const = default;
};

/// Stores images in files, one each, for later processes. Processes may share a folder. Files that are
/// damaged or of another format are ignored.
class ImageCache {
public:
    /// Creates the folder; an empty path stores nothing, and neither does one that cannot be created. Throws
    /// DeviceError when other users may have written to it.
    explicit ImageCache(std::filesystem::path folder);

    /// `key` contains everything that the image depends on. An image of another key is never returned.
    std::optional<Image> find(const std::string& key) const;

    /// Does nothing when the file cannot be written.
    void keep(const std::string& key, const Image& image) const;

private:
    std::filesystem::path file_of(const std::string& key) const;

    std::filesystem::path folder_;
};

} // namespace tandem::cuda
