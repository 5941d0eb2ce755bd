// SPDX-License-Identifier: MIT
#include "backends/cuda/image_cache.h"

#include "backends/device.h"
#include "base/private_folder.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>
#include <zlib.h>

namespace tandem::cuda {

namespace {

constexpr std::string_view magic = "tandem image 1\n";

using Parts = std::array<std::string, 4>; ///< key, target, log, bytes

std::uint32_t checksum(const std::string& text) {
    return static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const unsigned char*>(text.data()), text.size()));
}

template<class T>
void append(std::string& to, T value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Removes a number from the front; no value when too few bytes are left.
template<class T>
std::optional<T> taken(std::string_view& from) {
    if (from.size() < sizeof(T)) return std::nullopt;
    T value;
    std::copy_n(from.data(), sizeof value, reinterpret_cast<char*>(&value));
    from.remove_prefix(sizeof value);
    return value;
}

/// The magic, then the size, the bytes and the checksum of each part.
std::string packed(const Parts& parts) {
    std::string text(magic);
    for (const auto& part : parts) {
        append(text, std::uint64_t{part.size()});
        text += part;
        append(text, checksum(part));
    }
    return text;
}

std::optional<Parts> unpacked(std::string_view text) {
    if (!text.starts_with(magic)) return std::nullopt;
    text.remove_prefix(magic.size());
    Parts parts;
    for (auto& part : parts) {
        const auto size = taken<std::uint64_t>(text);
        if (!size || *size > text.size()) return std::nullopt;
        part = text.substr(0, *size);
        text.remove_prefix(*size);
        if (taken<std::uint32_t>(text) != checksum(part)) return std::nullopt;
    }
    return parts;
}

} // namespace

ImageCache::ImageCache(std::filesystem::path folder) : folder_(std::move(folder)) {
    if (folder_.empty()) return;
    if (make_own(folder_)) folder_.clear();
    if (const auto why = why_not_own(folder_); !why.empty())
        throw DeviceError(fmt::format("TANDEM_KERNEL_CACHE: {}", why));
}

std::filesystem::path ImageCache::file_of(const std::string& key) const {
    // FNV-1a. The file contains the key itself, which find() compares.
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : key) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return folder_ / fmt::format("{:016x}.image", hash);
}

std::optional<Image> ImageCache::find(const std::string& key) const {
    if (folder_.empty()) return std::nullopt;
    std::ifstream file(file_of(key), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    auto parts = unpacked(text);
    if (!parts || (*parts)[0] != key) return std::nullopt;
    return Image{std::move((*parts)[3]), std::move((*parts)[1]), std::move((*parts)[2])};
}

void ImageCache::keep(const std::string& key, const Image& image) const {
    if (folder_.empty()) return;
    // Written to a temporary file and renamed, so that readers see the whole file or none.
    static std::atomic<unsigned> number = 0;
    const auto file = file_of(key);
    auto temporary = file;
    temporary += fmt::format(".{}.{}", ::getpid(), number++);
    const auto text = packed({key, image.target, image.log, image.bytes});
    std::ofstream out(temporary, std::ios::binary);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    out.close();
    std::error_code code;
    if (out) std::filesystem::rename(temporary, file, code);
    if (!out || code) std::filesystem::remove(temporary, code);
}

} // namespace tandem::cuda
