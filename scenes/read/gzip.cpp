// SPDX-License-Identifier: MIT
#include "scenes/read/gzip.h"

#include "base/error.h"
#include "base/memory.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <limits>
#include <zlib.h>

namespace tandem::read {

namespace {

/// zlib's state, released in every case.
class Inflater {
public:
    /// 16 more than the window's bits selects the format of gzip (zlib.h).
    Inflater() { is_ready_ = inflateInit2(&stream_, MAX_WBITS + 16) == Z_OK; }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;
    ~Inflater() {
        if (is_ready_) inflateEnd(&stream_);
    }

    bool is_ready() const { return is_ready_; }
    z_stream& stream() { return stream_; }

private:
    z_stream stream_{};
    bool is_ready_ = false;
};

[[noreturn]] void fail(const std::string& source) {
    throw InputError(fmt::format("{}: the gzip data are damaged; copy or compress the file again", source));
}

} // namespace

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::string gunzipped(std::string_view bytes, const std::string& source) {
    Inflater inflater;
    if (!inflater.is_ready()) fail(source);
    auto& stream = inflater.stream();
    std::string result;
    std::array<char, 1 << 16> part;
    const auto limit = free_memory() / 3; // a growing text is in memory twice
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data())); // zlib only reads
    auto left = bytes.size();
    int status = Z_OK;
    do {
        // A count of zlib has 32 bits.
        const auto given = static_cast<uInt>(std::min<std::size_t>(left, std::numeric_limits<uInt>::max()));
        stream.avail_in = given;
        stream.next_out = reinterpret_cast<Bytef*>(part.data());
        stream.avail_out = static_cast<uInt>(part.size());
        status = inflate(&stream, Z_NO_FLUSH);
        left -= given - stream.avail_in;
        if (result.size() > limit)
            throw InputError(fmt::format(
                "{}: its content does not fit into memory; unpack it and give a smaller mesh", source));
        result.append(part.data(), part.size() - stream.avail_out);
        // Zeros behind a member are padding; anything else is another member.
        if (status == Z_STREAM_END && bytes.find_first_not_of('\0', bytes.size() - left) != bytes.npos)
            status = inflateReset(&stream);
    } while (status == Z_OK && (left > 0 || stream.avail_out == 0));
    if (status != Z_STREAM_END) fail(source);
    return result;
}

} // namespace tandem::read
