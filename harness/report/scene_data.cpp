// SPDX-License-Identifier: MIT
#include "harness/report/scene_data.h"

#include "harness/chunk_numbers.h"
#include "harness/frame_contacts.h"
#include "harness/report/base64.h"
#include "harness/report/interned.h"
#include "harness/report/quantised.h"
#include "scenes/export/world.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tandem::report {

namespace {

using exporting::Surface;
using Points = std::vector<Eigen::Vector3d>;

Json json_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// The points as they are drawn, in a box of their own.
Json points_json(const Points& points, const Quantised& in) {
    std::vector<std::uint16_t> coordinates;
    for (const auto& point : points) in.add(point, coordinates);
    return {{"lower", json_of(in.lower())}, {"size", json_of(in.size())}, {"points", base64(coordinates)}};
}

Eigen::AlignedBox3d box_of(const Points& points) {
    Eigen::AlignedBox3d box;
    for (const auto& point : points) box.extend(point);
    return box;
}

Points corners_of(const Eigen::AlignedBox3d& box) {
    Points corners;
    for (unsigned i = 0; i < 8; ++i)
        corners.emplace_back((i & 1 ? box.max() : box.min()).x(), (i & 2 ? box.max() : box.min()).y(),
                             (i & 4 ? box.max() : box.min()).z());
    return corners;
}

/// Sides of the box with these corners, counterclockwise from outside.
const std::vector<std::uint32_t> sides_of_box{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                              2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

/// The vertices of a body's surface, or the corners of their box.
Points shown_points(const Surface& surface, const Points& vertices, bool boxed) {
    Points points;
    for (const auto vertex : surface.vertices) points.push_back(vertices[vertex]);
    return boxed ? corners_of(box_of(points)) : points;
}

/// Makes the JSON of one scene.
class SceneJson {
public:
    SceneJson(const Scene& scene, std::span<const std::size_t> frames, const SceneBudget& budget,
              bool contacts);

    void add_meshes();
    void add_frames(FrameContacts* finder);
    std::string text();

private:
    void choose_frames(std::span<const std::size_t> wanted);
    void note_what_is_left_out(std::size_t wanted);
    void add_frame(const Frame& frame, FrameContacts* finder);
    void add_contacts(const std::vector<ContactPoint>& found);
    void write_poses();
    void write_contacts();

    const Scene& scene_;
    std::vector<Surface> surfaces_;
    SceneCut cut_;
    std::vector<std::size_t> frames_;
    std::vector<std::vector<Pose>> poses_;
    std::vector<Points> points_, normals_; ///< of the contacts shown, by frame
    Json json_, notes_ = Json::array();
};

SceneJson::SceneJson(const Scene& scene, std::span<const std::size_t> frames, const SceneBudget& budget,
                     bool contacts)
    : scene_(scene) {
    SceneSizes sizes{.bodies = scene.bodies.size(), .frames = frames.size(), .contacts = contacts};
    for (const auto& mesh : scene.meshes) {
        const auto& surface = surfaces_.emplace_back(exporting::surface_of(mesh));
        sizes.meshes.push_back({surface.vertices.size(), surface.triangles.size() / 3, 0, 0});
    }
    for (const auto& body : scene.bodies) {
        ++sizes.meshes[body.mesh].bodies;
        sizes.meshes[body.mesh].deformable += body.deformable ? 1 : 0;
    }
    cut_ = cut(sizes, budget);
    choose_frames(frames);
    note_what_is_left_out(frames.size());
    json_ = {{"name", scene.name},
             {"key", scene.key},
             {"units", scene.units},
             {"frames", frames_},
             {"bodies", cut_.bodies},
             {"of_bodies", scene.bodies.size()},
             {"tetrahedra", tetrahedron_count(scene)}};
    if (scene.time)
        for (const auto frame : frames_) json_["times"].push_back(rounded(scene.time(frame)));
}

/// Of more than fit as many, evenly, the first and the last among them.
void SceneJson::choose_frames(std::span<const std::size_t> wanted) {
    const auto last = std::max<std::size_t>(cut_.frames, 2) - 1;
    for (std::size_t i = 0; i < cut_.frames; ++i) frames_.push_back(wanted[i * (wanted.size() - 1) / last]);
}

void SceneJson::note_what_is_left_out(std::size_t wanted) {
    const auto boxed = std::ranges::count(cut_.boxed, true);
    if (boxed > 0)
        notes_.push_back(
            fmt::format("bodies of {} of {} meshes are drawn as boxes: their surfaces are too large for a "
                        "page",
                        boxed, cut_.boxed.size()));
    if (cut_.bodies < scene_.bodies.size())
        notes_.push_back(
            fmt::format("the first {} of {} bodies are shown", cut_.bodies, scene_.bodies.size()));
    if (cut_.frames < wanted)
        notes_.push_back(fmt::format("{} of {} frames are shown, evenly taken", cut_.frames, wanted));
}

void SceneJson::add_meshes() {
    json_["meshes"] = Json::array();
    for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
        const auto& surface = surfaces_[i];
        const bool boxed = cut_.boxed[i];
        const auto points = shown_points(surface, scene_.meshes[i].vertices, boxed);
        auto mesh = points_json(points, Quantised(box_of(points)));
        const auto& triangles = boxed ? sides_of_box : surface.triangles;
        const bool wide = points.size() > 65536;
        mesh["name"] = scene_.meshes[i].name;
        mesh["wide"] = wide;
        mesh["triangles"] =
            wide ? base64(triangles) : base64(std::vector<std::uint16_t>(triangles.begin(), triangles.end()));
        std::vector<std::uint8_t> chunks(triangles.size() / 3);
        const auto numbers = chunk_numbers(scene_.meshes[i]);
        if (!boxed)
            for (std::size_t t = 0; t < chunks.size(); ++t)
                chunks[t] = static_cast<std::uint8_t>(numbers[surface.tetrahedra[t]] % 256);
        mesh["chunks"] = base64(chunks);
        json_["meshes"].push_back(std::move(mesh));
    }
    std::vector<std::uint32_t> meshes;
    std::vector<std::uint8_t> kinds;
    for (std::size_t body = 0; body < cut_.bodies; ++body) {
        const auto& of = scene_.bodies[body];
        meshes.push_back(of.mesh);
        kinds.push_back(static_cast<std::uint8_t>((of.fixed ? 1 : 0) + (of.deformable ? 2 : 0)));
    }
    json_["body_meshes"] = base64(meshes);
    json_["body_kinds"] = base64(kinds);
}

void SceneJson::add_frame(const Frame& frame, FrameContacts* finder) {
    poses_.emplace_back(frame.poses.begin(), frame.poses.begin() + static_cast<std::ptrdiff_t>(cut_.bodies));
    Json deformed = Json::array();
    for (std::size_t body = 0; body < cut_.bodies; ++body) {
        const auto mesh = scene_.bodies[body].mesh;
        if (!scene_.bodies[body].deformable) continue;
        const auto points = shown_points(surfaces_[mesh], frame.deformed[body], cut_.boxed[mesh]);
        deformed.push_back(points_json(points, Quantised(box_of(points))));
    }
    json_["deformed"].push_back(std::move(deformed));
    if (finder) add_contacts(finder->of(frame));
}

/// Of more than fit evenly as many.
void SceneJson::add_contacts(const std::vector<ContactPoint>& found) {
    auto& points = points_.emplace_back();
    auto& normals = normals_.emplace_back();
    const auto shown = std::min(found.size(), cut_.contacts);
    for (std::size_t i = 0; i < shown; ++i) {
        const auto& contact = found[i * found.size() / shown];
        points.emplace_back(contact.point.data());
        normals.emplace_back(contact.normal.data());
    }
    json_["contacts"].push_back({{"found", found.size()}});
}

void SceneJson::add_frames(FrameContacts* finder) {
    for (const auto frame : frames_) add_frame(scene_.frame(frame), finder);
    write_poses();
    if (finder) write_contacts();
}

void SceneJson::write_poses() {
    Eigen::AlignedBox3d box;
    for (const auto& poses : poses_)
        for (const auto& pose : poses) box.extend(pose.translation);
    const Quantised in(box);
    json_["lower"] = json_of(in.lower());
    json_["size"] = json_of(in.size());
    for (const auto& poses : poses_) {
        std::vector<std::uint16_t> numbers;
        for (const auto& [rotation, translation] : poses) {
            in.add(translation, numbers);
            for (const double x : rotation.coeffs()) // x, y, z, w
                numbers.push_back(
                    static_cast<std::uint16_t>(std::lround(std::clamp(x, -1.0, 1.0) * 32767) + 32768));
        }
        json_["poses"].push_back(base64(numbers));
    }
}

void SceneJson::write_contacts() {
    Eigen::AlignedBox3d box;
    std::size_t all = 0;
    std::size_t shown = 0;
    for (const auto& points : points_)
        for (const auto& point : points) box.extend(point);
    const Quantised in(box);
    for (std::size_t i = 0; i < points_.size(); ++i) {
        std::vector<std::int8_t> normals;
        for (const auto& normal : normals_[i])
            for (const double x : normal)
                normals.push_back(static_cast<std::int8_t>(std::lround(std::clamp(x, -1.0, 1.0) * 127)));
        auto& contacts = json_["contacts"][i];
        contacts.update(points_json(points_[i], in));
        contacts["normals"] = base64(normals);
        all += contacts["found"].get<std::size_t>();
        shown += points_[i].size();
    }
    if (shown < all) notes_.push_back(fmt::format("{} of {} contacts are shown, evenly taken", shown, all));
}

std::string SceneJson::text() {
    json_["notes"] = notes_;
    return json_.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace

std::string scene_data(const Scene& scene, std::span<const std::size_t> frames, FrameContacts* finder,
                       const SceneBudget& budget) {
    SceneJson json(scene, frames, budget, finder != nullptr);
    json.add_meshes();
    json.add_frames(finder);
    return json.text();
}

} // namespace tandem::report
