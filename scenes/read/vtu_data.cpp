// SPDX-License-Identifier: MIT
#include "scenes/read/vtu_data.h"

#include "base/base64.h"
#include "base/memory.h"

#include <algorithm>
#include <charconv>
#include <array>
#include <limits>
#include <lz4.h>
#include <lzma.h>
#include <zlib.h>

namespace tandem::read {

/// One compressor of VTK. `unpack` fills `to` from `from`; false unless it is filled exactly.
struct Compressor {
    std::string_view name;
    std::uint64_t best_ratio; ///< of bytes to packed bytes
    bool (*unpack)(std::string_view from, std::span<char> to);
};

namespace {

bool unpack_zlib(std::string_view from, std::span<char> to) {
    uLongf got = to.size();
    const auto status = uncompress(reinterpret_cast<Bytef*>(to.data()), &got,
                                   reinterpret_cast<const Bytef*>(from.data()), from.size());
    return status == Z_OK && got == to.size();
}

bool unpack_lz4(std::string_view from, std::span<char> to) {
    constexpr std::size_t most = std::numeric_limits<int>::max();
    if (from.size() > most || to.size() > most) return false;
    const auto got = LZ4_decompress_safe(from.data(), to.data(), static_cast<int>(from.size()),
                                         static_cast<int>(to.size()));
    return got >= 0 && static_cast<std::size_t>(got) == to.size();
}

bool unpack_lzma(std::string_view from, std::span<char> to) {
    std::uint64_t memory = std::uint64_t{1} << 30;
    std::size_t taken = 0, got = 0;
    const auto status = lzma_stream_buffer_decode(
        &memory, 0, nullptr, reinterpret_cast<const std::uint8_t*>(from.data()), &taken, from.size(),
        reinterpret_cast<std::uint8_t*>(to.data()), &got, to.size());
    return status == LZMA_OK && got == to.size();
}

/// The ratio of deflate is by zlib's technical notes, that of LZ4 by its format (255 bytes a byte of length).
/// That of LZMA is a bound above what zeros reach.
constexpr std::array compressors = {Compressor{"vtkZLibDataCompressor", 1032, unpack_zlib},
                                    Compressor{"vtkLZ4DataCompressor", 256, unpack_lz4},
                                    Compressor{"vtkLZMADataCompressor", 1 << 14, unpack_lzma}};

} // namespace

VtuData::VtuData(const Xml& xml, const Tag& file) : xml_(xml) {
    const auto order = file.get("byte_order", "LittleEndian");
    if (order != "LittleEndian" && order != "BigEndian")
        xml.fail(file.at, fmt::format("unknown byte_order {}", in_quotes(order)), "export the file again");
    if (order == "BigEndian") order_ = std::endian::big;
    const auto header = file.get("header_type", "UInt32");
    if (header != "UInt32" && header != "UInt64")
        xml.fail(file.at, fmt::format("unknown header_type {}", in_quotes(header)),
                 "save with UInt32 or UInt64");
    header_size_ = header == "UInt32" ? 4 : 8;
    const auto compressor = file.get("compressor");
    if (compressor.empty()) return;
    compressor_ = std::ranges::find(compressors, compressor, &Compressor::name);
    if (compressor_ == compressors.end())
        xml.fail(file.at, fmt::format("compressor {} is not supported", in_quotes(compressor)),
                 "save with vtkZLibDataCompressor, vtkLZ4DataCompressor, vtkLZMADataCompressor or without "
                 "compression");
}

void VtuData::set_appended(const Tag& tag) {
    const auto encoding = tag.get("encoding");
    if (encoding != "raw" && encoding != "base64")
        xml_.fail(tag.at, fmt::format("unknown encoding {} of AppendedData", in_quotes(encoding)),
                  "save with base64 or raw");
    appended_base64_ = encoding == "base64";
    const auto start = xml_.text().find('_', tag.content);
    if (start == std::string_view::npos)
        xml_.fail(tag.at, "AppendedData has no '_'", "it is truncated: copy or export it again");
    appended_ = start + 1;
}

Number VtuData::type_of(const Tag& array) const {
    const auto type = number_type(array.get("type"));
    if (!type)
        xml_.fail(array.at, fmt::format("number type {} is not supported", in_quotes(array.get("type"))),
                  "save as Float32 or Float64, and Int32 or Int64");
    return *type;
}

std::size_t VtuData::end_of(const Tag& array) const {
    const auto end = array.closed ? array.content : xml_.text().find('<', array.content);
    if (end == std::string_view::npos)
        xml_.fail(array.at, "DataArray has no end", "the file is truncated: copy or export it again");
    return end;
}

VtuData::Block VtuData::block_of(const Tag& array) const {
    const auto format = array.get("format");
    if (format == "binary")
        return {xml_.text().substr(array.content, end_of(array) - array.content), true, array.at};
    if (format != "appended")
        xml_.fail(array.at, fmt::format("unknown format {} of DataArray", in_quotes(format)),
                  "save as ascii, binary or appended");
    if (appended_ == 0) xml_.fail(array.at, "no AppendedData for this DataArray", "export the file again");
    const auto text = array.get("offset");
    const auto bytes = xml_.text().substr(appended_);
    std::uint64_t offset = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), offset);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() || offset > bytes.size())
        xml_.fail(array.at, fmt::format("offset {} is not inside AppendedData", in_quotes(text)),
                  "it may be truncated: copy or export the file again");
    return {bytes.substr(offset), appended_base64_, array.at};
}

/// The first `bytes` bytes of a block.
std::string VtuData::head(const Block& block, std::uint64_t bytes) const {
    // Base64 has more characters than bytes, so that this limits the allocation in both encodings.
    const bool fits = bytes <= block.stored.size();
    if (fits && !block.base64) return std::string(block.stored.substr(0, bytes));
    auto data = fits ? base64::decode(block.stored, bytes) : std::string();
    if (!data) xml_.fail(block.tag, "the data are not base64", "copy or export the file again");
    if (data->size() < bytes || !fits)
        xml_.fail(block.tag, fmt::format("the data end before {} announced bytes", bytes),
                  "they are truncated: copy or export the file again");
    return std::move(*data);
}

std::uint64_t VtuData::header_value(std::string_view data, std::size_t i) const {
    Cursor in(data, xml_.source(), i * header_size_, order_);
    return header_size_ == 4 ? in.get<std::uint32_t>("a header") : in.get<std::uint64_t>("a header");
}

/// Decodes a block: a header with the number of bytes, then the bytes.
std::string VtuData::decode(const Block& block) const {
    if (compressor_ != nullptr) return inflate(block);
    const auto bytes = header_value(head(block, header_size_), 0);
    if (bytes > block.stored.size()) head(block, bytes); // fails; the sum below could wrap
    return head(block, header_size_ + bytes).substr(header_size_);
}

/// Decompresses a block. Its header has the number of parts, the size of a part, the size of the last part if
/// smaller, and the compressed size of each part.
std::string VtuData::inflate(const Block& block) const {
    const auto start = head(block, header_size_);
    const auto parts = header_value(start, 0);
    if (parts == 0) return "";
    if (parts > block.stored.size()) head(block, parts);
    const auto header = head(block, header_size_ * (3 + parts));
    std::uint64_t stored = header.size();
    for (std::size_t i = 0; i < parts; ++i) {
        const auto size = header_value(header, 3 + i);
        if (size > block.stored.size()) head(block, size);
        stored += size;
    }
    const auto data = head(block, stored);
    const auto whole = header_value(header, 1), last = header_value(header, 2);
    const auto most = compressor_->best_ratio * data.size();
    const auto end = last != 0 ? std::min(last, whole) : whole;
    if (end > most || (parts > 1 && whole > most / (parts - 1)))
        xml_.fail(block.tag, fmt::format("{} bytes cannot contain {} parts of {}", data.size(), parts, whole),
                  "copy or export the file again");
    refuse_beyond_memory(fmt::format("{}: an array", xml_.source()),
                         static_cast<double>(whole) * static_cast<double>(parts - 1)
                             + static_cast<double>(end));
    std::string result;
    std::size_t at = header.size();
    for (std::size_t i = 0; i < parts; ++i) {
        const auto size = header_value(header, 3 + i);
        const auto bytes = i + 1 == parts ? end : whole;
        const auto begin = result.size();
        result.resize(begin + bytes);
        if (!compressor_->unpack(std::string_view(data).substr(at, size), std::span(result).subspan(begin)))
            xml_.fail(block.tag, fmt::format("part {} does not decompress", i),
                      "copy or export the file again");
        at += size;
    }
    return result;
}

} // namespace tandem::read
