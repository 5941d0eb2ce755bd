// SPDX-License-Identifier: MIT
#include "scenes/recording/frame.h"

#include "base/error.h"
#include "scenes/motion.h"
#include "scenes/read/cursor.h"
#include "scenes/recording/bytes.h"

#include <cmath>
#include <fmt/format.h>

namespace tandem::recording {

namespace {

/// The checksum includes the frame's number, so that a frame at another position does not match.
std::uint32_t frame_checksum(std::string_view bytes, std::uint64_t number) {
    std::string start;
    put(start, number);
    return checksum(bytes, checksum(start));
}

/// Appends numbers rounded to float; false when one is not finite.
bool put_floats(std::string& out, std::initializer_list<double> numbers) {
    bool finite = true;
    for (const double number : numbers) {
        const auto value = static_cast<float>(number);
        finite = finite && std::isfinite(value);
        put_float(out, value);
    }
    return finite;
}

bool is_rotation(const Eigen::Quaterniond& q) {
    constexpr double slack = 1e-3; // far above the change of the norm by rounding to float
    return std::fabs((q.w() * q.w() + q.x() * q.x()) + (q.y() * q.y() + q.z() * q.z()) - 1) < slack;
}

/// Appends a pose; false when it is not finite in float or not a rotation.
bool put_pose(std::string& out, const Pose& pose) {
    const auto& q = pose.rotation;
    const auto& t = pose.translation;
    return put_floats(out, {t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()}) && is_rotation(q);
}

bool put_vertices(std::string& out, const std::vector<Eigen::Vector3d>& vertices) {
    bool finite = true;
    for (const auto& v : vertices) finite = put_floats(out, {v.x(), v.y(), v.z()}) && finite;
    return finite;
}

/// Reads a float, also one that is not finite.
double get_float(read::Cursor& in) {
    return static_cast<double>(std::bit_cast<float>(in.get<std::uint32_t>("a number")));
}

Eigen::Vector3d get_vector(read::Cursor& in) {
    const double x = get_float(in), y = get_float(in), z = get_float(in);
    return {x, y, z};
}

/// False when the pose is not finite or not a rotation.
bool get_pose(read::Cursor& in, Pose& pose) {
    pose.translation = get_vector(in);
    const double w = get_float(in), x = get_float(in), y = get_float(in), z = get_float(in);
    const Eigen::Quaterniond q(w, x, y, z);
    if (!is_rotation(q)) return false;
    pose.rotation = unit(q);
    return pose.translation.allFinite();
}

bool get_vertices(read::Cursor& in, std::uint32_t count, std::vector<Eigen::Vector3d>& vertices) {
    bool finite = true;
    vertices.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        vertices.push_back(get_vector(in));
        finite = finite && vertices.back().allFinite();
    }
    return finite;
}

} // namespace

std::string encode(const RecordingHeader& header, std::uint64_t number, std::uint64_t step, double time,
                   const Frame& frame, const std::string& path) {
    const auto fail = [&](std::size_t body, std::string_view what) {
        throw InputError(fmt::format("{}: body {} of frame {} {}", path, body, number, what));
    };
    if (frame.poses.size() != header.bodies.size() || frame.deformed.size() != header.bodies.size())
        throw InputError(fmt::format("{}: frame {} has {} bodies, the recording {}", path, number,
                                     frame.poses.size(), header.bodies.size()));
    if (!std::isfinite(time))
        throw InputError(fmt::format("{}: the time of frame {} is not finite", path, number));
    std::string out;
    out.reserve(frame_bytes(header));
    put(out, step);
    put_double(out, time);
    for (std::size_t i = 0; i < header.bodies.size(); ++i) {
        const auto& body = header.bodies[i];
        bool finite = true;
        if (body.kind == RecordedKind::rigid) finite = put_pose(out, frame.poses[i]);
        if (body.kind == RecordedKind::deformable) {
            if (frame.deformed[i].size() != body.vertices)
                fail(i, fmt::format("has {} vertices, not {}", frame.deformed[i].size(), body.vertices));
            finite = put_vertices(out, frame.deformed[i]);
        }
        if (!finite) fail(i, "is beyond single precision or not turned by a rotation; the motion diverged");
    }
    put(out, frame_checksum(out, number));
    return out;
}

bool matches(std::string_view bytes, std::uint64_t number) {
    const auto body = bytes.substr(0, bytes.size() - sizeof(std::uint32_t));
    read::Cursor in(bytes, "", body.size());
    return in.get<std::uint32_t>("checksum") == frame_checksum(body, number);
}

RecordedFrame decode(const RecordingHeader& header, std::string_view bytes, const std::vector<Pose>& fixed,
                     const std::string& location) {
    read::Cursor in(bytes, location);
    RecordedFrame recorded;
    recorded.step = in.get<std::uint64_t>("step");
    recorded.time = std::bit_cast<double>(in.get<std::uint64_t>("time"));
    bool valid = std::isfinite(recorded.time);
    auto& frame = recorded.frame;
    frame.poses.resize(header.bodies.size());
    frame.deformed.resize(header.bodies.size());
    for (std::size_t i = 0; i < header.bodies.size(); ++i) {
        const auto& body = header.bodies[i];
        if (body.kind == RecordedKind::fixed) frame.poses[i] = fixed[i];
        if (body.kind == RecordedKind::rigid) valid = get_pose(in, frame.poses[i]) && valid;
        if (body.kind == RecordedKind::deformable)
            valid = get_vertices(in, body.vertices, frame.deformed[i]) && valid;
    }
    if (!valid)
        throw InputError(fmt::format(
            "{} has a body that is not finite or not turned by a rotation; record it again", location));
    return recorded;
}

} // namespace tandem::recording
