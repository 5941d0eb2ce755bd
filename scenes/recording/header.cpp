// SPDX-License-Identifier: MIT
#include "scenes/recording/header.h"

#include "base/error.h"
#include "scenes/read/cursor.h"
#include "scenes/recording/bytes.h"

#include <cmath>
#include <fmt/format.h>

namespace tandem {

std::vector<RecordedBody> recorded_bodies(const Scene& scene) {
    std::vector<RecordedBody> bodies;
    for (const auto& body : scene.bodies) {
        const auto vertices = static_cast<std::uint32_t>(scene.meshes[body.mesh].vertices.size());
        if (body.deformable)
            bodies.push_back({RecordedKind::deformable, vertices});
        else
            bodies.push_back({body.fixed ? RecordedKind::fixed : RecordedKind::rigid, 0});
    }
    return bodies;
}

namespace recording {

namespace {

// As in PNG, the first byte is not text, and a copy that changes line ends changes these bytes.
constexpr std::string_view magic("\x89TDMFR\r\n", 8);
constexpr std::uint64_t bytes_before_specification = 40;

/// The bytes of the header. Throws InputError for other files and when the checksum does not match.
std::string checked_bytes(const RecordingFile& file) {
    const auto fail = [&](std::string_view what) {
        throw InputError(fmt::format("{}: {}", file.path(), what));
    };
    const auto size = file.size();
    const auto start = file.read(0, std::min<std::uint64_t>(size, 16));
    if (!start.starts_with(magic.substr(0, start.size())))
        fail("is not a recording of frames; name one that 'tandem simulate' wrote");
    if (start.size() < 16) fail("is cut off in its header; record it again");
    read::Cursor in(start, file.path(), magic.size());
    if (const auto found = in.get<std::uint32_t>("version"); found != version)
        fail(fmt::format("has version {} of the format, this program reads version {}; record it again",
                         found, version));
    const auto bytes = in.get<std::uint32_t>("size");
    if (bytes > size) fail("is cut off in its header; record it again");
    auto header = file.read(0, bytes);
    const bool whole = bytes >= bytes_before_specification + sizeof(std::uint32_t);
    const auto body = std::string_view(header).substr(0, whole ? bytes - sizeof(std::uint32_t) : 0);
    if (!whole
        || read::Cursor(header, file.path(), body.size()).get<std::uint32_t>("checksum") != checksum(body))
        fail("does not match its checksum in the header; copy or record it again");
    return header;
}

RecordedBody read_body(read::Cursor& in) {
    const auto kind = in.get<std::uint32_t>("the kind of a body");
    if (kind > static_cast<std::uint32_t>(RecordedKind::deformable))
        in.fail(fmt::format("{} is not a kind of body", kind), "record it again");
    return {static_cast<RecordedKind>(kind), in.get<std::uint32_t>("the vertices of a body")};
}

} // namespace

/// Fixed bodies have no bytes, since the scene has their poses.
std::uint64_t frame_bytes(const RecordingHeader& header) {
    std::uint64_t bytes = 8 + 8 + 4;
    for (const auto& body : header.bodies) {
        bytes += body.kind == RecordedKind::rigid ? 7 * sizeof(float) : 0;
        bytes += body.kind == RecordedKind::deformable ? std::uint64_t{body.vertices} * 3 * sizeof(float) : 0;
    }
    return bytes;
}

std::string encode(const RecordingHeader& header) {
    const auto size = bytes_before_specification + header.specification.size() + header.bodies.size() * 8
                      + sizeof(std::uint32_t);
    std::string out(magic);
    put(out, version);
    put(out, static_cast<std::uint32_t>(size));
    put(out, header.scene_digest);
    put_double(out, header.seconds_per_frame);
    put(out, static_cast<std::uint32_t>(header.bodies.size()));
    put(out, static_cast<std::uint32_t>(header.specification.size()));
    out += header.specification;
    for (const auto& body : header.bodies) {
        put(out, static_cast<std::uint32_t>(body.kind));
        put(out, body.vertices);
    }
    return sealed(std::move(out));
}

std::pair<RecordingHeader, std::uint64_t> read_header(const RecordingFile& file) {
    const auto bytes = checked_bytes(file);
    const auto body = std::string_view(bytes).substr(0, bytes.size() - sizeof(std::uint32_t));
    read::Cursor in(body, file.path(), magic.size() + 8);
    RecordingHeader header;
    header.scene_digest = in.get<std::uint64_t>("digest");
    header.seconds_per_frame = std::bit_cast<double>(in.get<std::uint64_t>("seconds"));
    if (!(header.seconds_per_frame >= 0 && std::isfinite(header.seconds_per_frame)))
        in.fail("the seconds per frame are not a valid time", "record it again");
    const auto count = in.get<std::uint32_t>("count of bodies");
    const auto length = in.get<std::uint32_t>("length of the scene's text");
    if (bytes_before_specification + length + std::uint64_t{count} * 8 != body.size())
        in.fail("bodies and scene do not fill the header", "record it again");
    header.specification = body.substr(in.at(), length);
    read::Cursor rest(body, file.path(), in.at() + length);
    while (!rest.done()) header.bodies.push_back(read_body(rest));
    return {std::move(header), bytes.size()};
}

} // namespace recording

} // namespace tandem
