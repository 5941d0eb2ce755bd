// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace tandem::cuda {

/// What a compilation gave.
struct Image {
    std::string bytes;  ///< CUBIN or PTX, ready to be loaded as a module
    std::string target; ///< "sm_90 cubin" or "compute_90 ptx"
    std::string log;

    bool operator==(const Image&) const = default;
};

/// Images kept in files, one each, from one process to the next. Processes may share a folder. A file that is
/// damaged or of another format counts as none.
class ImageCache {
public:
    /// An empty path keeps nothing. Makes the folder; throws DeviceError when it cannot.
    explicit ImageCache(std::filesystem::path folder);

    /// `key`: all that the image depends on, in full: an image of another key is never given.
    std::optional<Image> find(const std::string& key) const;

    /// Where the file cannot be written nothing is kept.
    void keep(const std::string& key, const Image& image) const;

private:
    std::filesystem::path file_of(const std::string& key) const;

    std::filesystem::path folder_;
};

} // namespace tandem::cuda
