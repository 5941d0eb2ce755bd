// SPDX-License-Identifier: MIT
#include "scenes/export/geometry.h"

#include "scenes/export/colour_scale.h"
#include "scenes/export/geometry_surfaces.h"
#include "scenes/export/world.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace tandem {

namespace exporting {

namespace {

/// Rounds to six digits, which is enough for a screen.
double six_digits(double value) { return std::stod(fmt::format("{:.6g}", value)); }

Points corners_of(const Eigen::AlignedBox3d& box) {
    Points corners;
    for (unsigned i = 0; i < 8; ++i)
        corners.emplace_back((i & 1 ? box.max() : box.min()).x(), (i & 2 ? box.max() : box.min()).y(),
                             (i & 4 ? box.max() : box.min()).z());
    return corners;
}

/// Triangles of the box with these corners, counterclockwise from outside.
const std::vector<std::uint32_t> sides_of_box{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                              2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

/// The vertices of a body's surface, or the corners of their box.
Points shown_points(const BoundarySurface& surface, const Points& vertices, bool boxed) {
    Points points;
    for (const auto vertex : surface.vertices) points.push_back(vertices[vertex]);
    return boxed ? corners_of(box_of(points)) : points;
}

GeometrySizes sizes_of(const Scene& scene, const std::vector<BoundarySurface>& surfaces, std::size_t frames) {
    GeometrySizes sizes{.bodies = scene.bodies.size(), .frames = frames};
    for (const auto& surface : surfaces)
        sizes.meshes.push_back({surface.vertices.size(), surface.triangles.size() / 3, 0, 0});
    for (const auto& body : scene.bodies) {
        ++sizes.meshes[body.mesh].bodies;
        sizes.meshes[body.mesh].deformable += body.deformable ? 1 : 0;
    }
    return sizes;
}

/// The most bytes of contact surfaces of the first, the middle and the last frame.
std::size_t most_surface_bytes(const Scene& scene, std::span<const std::size_t> frames,
                               const FindSurfaces& find) {
    std::size_t bytes = 0;
    for (const auto i : std::set{frames.front(), frames[frames.size() / 2], frames.back()})
        bytes = std::max(bytes, surface_bytes(find(i, scene.frame(i))));
    return bytes;
}

/// The largest penetration depth of the contacts of all frames; 0 without contacts that penetrate.
double deepest_of(const std::vector<std::vector<double>>& depths) {
    double deepest = 0;
    for (const auto& own : depths)
        for (const double depth : own)
            if (std::isfinite(depth)) deepest = std::max(deepest, -depth);
    return deepest;
}

/// Depths as parts of the deepest one, in 16 bits: 0 touches or is apart, 65534 is the deepest, and 65535 has
/// no depth.
std::vector<std::uint16_t> scaled(const std::vector<double>& depths, double deepest) {
    std::vector<std::uint16_t> parts;
    for (const double depth : depths) {
        const auto part = deepest > 0 ? std::clamp(-depth / deepest, 0.0, 1.0) : 0.0;
        parts.push_back(static_cast<std::uint16_t>(std::isfinite(depth) ? std::lround(part * 65534) : 65535));
    }
    return parts;
}

/// Builds the JSON of one scene.
class GeometryJson {
public:
    GeometryJson(const Scene& scene, std::span<const std::size_t> frames, const GeometryParts& parts,
                 const GeometryBudget& budget);

    void add_meshes();
    void add_frames();
    std::string text();

private:
    void choose_frames(std::span<const std::size_t> wanted);
    void add_omission_notes(std::size_t wanted);
    void add_frame(std::size_t number, const Frame& frame);
    void add_contacts(const std::vector<ContactPoint>& found);
    void write_poses();
    void write_contacts();

    const Scene& scene_;
    const GeometryParts& parts_;
    std::vector<BoundarySurface> surfaces_;
    GeometryCut cut_;
    std::vector<std::size_t> frames_;
    std::vector<std::vector<Pose>> poses_;
    std::vector<Points> points_, normals_;    ///< shown contacts, by frame
    std::vector<std::vector<double>> depths_; ///< of these contacts; in the scene's unit of length
    GeometrySurfaces contact_surfaces_;
    OrderedJson json_, notes_ = OrderedJson::array();
};

GeometryJson::GeometryJson(const Scene& scene, std::span<const std::size_t> frames,
                           const GeometryParts& parts, const GeometryBudget& budget)
    : scene_(scene), parts_(parts) {
    for (const auto& mesh : scene.meshes) surfaces_.push_back(surface_of(mesh));
    auto sizes = sizes_of(scene, surfaces_, frames.size());
    sizes.contacts = static_cast<bool>(parts.contacts);
    if (parts.surfaces) sizes.surface_bytes = most_surface_bytes(scene, frames, parts.surfaces);
    cut_ = cut(sizes, budget);
    choose_frames(frames);
    add_omission_notes(frames.size());
    json_ = {{"name", scene.name},
             {"key", scene.key},
             {"units", scene.units},
             {"frames", frames_},
             {"of_frames", frames.size()},
             {"bodies", cut_.bodies},
             {"of_bodies", scene.bodies.size()},
             {"tetrahedra", tetrahedron_count(scene)}};
    if (scene.time)
        for (const auto frame : frames_) json_["times"].push_back(six_digits(scene.time(frame)));
}

/// Selects evenly spaced frames, including the first and the last.
void GeometryJson::choose_frames(std::span<const std::size_t> wanted) {
    const auto last = std::max<std::size_t>(cut_.frames, 2) - 1;
    for (std::size_t i = 0; i < cut_.frames; ++i) frames_.push_back(wanted[i * (wanted.size() - 1) / last]);
}

void GeometryJson::add_omission_notes(std::size_t wanted) {
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
        notes_.push_back(fmt::format("{} of {} frames are shown, evenly spaced", cut_.frames, wanted));
}

void GeometryJson::add_meshes() {
    json_["meshes"] = OrderedJson::array();
    for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
        const auto& surface = surfaces_[i];
        const bool boxed = cut_.boxed[i];
        const auto points = shown_points(surface, scene_.meshes[i].vertices, boxed);
        auto mesh = points_json(points, Quantised(box_of(points)));
        const auto& triangles = boxed ? sides_of_box : surface.triangles;
        const bool wide = points.size() > 65536;
        mesh["name"] = scene_.meshes[i].name;
        mesh["wide"] = wide;
        mesh["triangles"] = wide ? base64_of(triangles)
                                 : base64_of(std::vector<std::uint16_t>(triangles.begin(), triangles.end()));
        std::vector<std::uint8_t> chunks(triangles.size() / 3);
        const auto numbers = parts_.chunks(scene_.meshes[i]);
        if (!boxed)
            for (std::size_t t = 0; t < chunks.size(); ++t)
                chunks[t] = static_cast<std::uint8_t>(numbers[surface.tetrahedra[t]] % 256);
        mesh["chunks"] = base64_of(chunks);
        json_["meshes"].push_back(std::move(mesh));
    }
    std::vector<std::uint32_t> meshes;
    std::vector<std::uint8_t> kinds;
    for (std::size_t body = 0; body < cut_.bodies; ++body) {
        const auto& source = scene_.bodies[body];
        meshes.push_back(source.mesh);
        kinds.push_back(static_cast<std::uint8_t>((source.fixed ? 1 : 0) + (source.deformable ? 2 : 0)));
    }
    json_["body_meshes"] = base64_of(meshes);
    json_["body_kinds"] = base64_of(kinds);
}

void GeometryJson::add_frame(std::size_t number, const Frame& frame) {
    poses_.emplace_back(frame.poses.begin(), frame.poses.begin() + static_cast<std::ptrdiff_t>(cut_.bodies));
    OrderedJson deformed = OrderedJson::array();
    for (std::size_t body = 0; body < cut_.bodies; ++body) {
        const auto mesh = scene_.bodies[body].mesh;
        if (!scene_.bodies[body].deformable) continue;
        const auto points = shown_points(surfaces_[mesh], frame.deformed[body], cut_.boxed[mesh]);
        deformed.push_back(points_json(points, Quantised(box_of(points))));
    }
    json_["deformed"].push_back(std::move(deformed));
    if (parts_.contacts) add_contacts(parts_.contacts(frame));
    if (parts_.surfaces) contact_surfaces_.add(parts_.surfaces(number, frame), cut_.surface_bytes);
}

/// Selects evenly spaced contacts.
void GeometryJson::add_contacts(const std::vector<ContactPoint>& found) {
    auto& points = points_.emplace_back();
    auto& normals = normals_.emplace_back();
    auto& depths = depths_.emplace_back();
    const auto shown = std::min(found.size(), cut_.contacts);
    for (std::size_t i = 0; i < shown; ++i) {
        const auto& contact = found[i * found.size() / shown];
        points.emplace_back(contact.point.data());
        normals.emplace_back(contact.normal.data());
        depths.push_back(contact.depth);
    }
    json_["contacts"].push_back({{"found", found.size()}});
}

void GeometryJson::add_frames() {
    for (const auto frame : frames_) add_frame(frame, scene_.frame(frame));
    write_poses();
    if (parts_.contacts || parts_.surfaces) json_["colours"] = scale_colours;
    if (parts_.contacts) write_contacts();
    if (parts_.surfaces) contact_surfaces_.write(json_, notes_);
}

void GeometryJson::write_poses() {
    Eigen::AlignedBox3d box;
    for (const auto& poses : poses_)
        for (const auto& pose : poses) box.extend(pose.translation);
    const Quantised quantised(box);
    json_["lower"] = json_of(quantised.lower());
    json_["size"] = json_of(quantised.size());
    for (const auto& poses : poses_) {
        std::vector<std::uint16_t> numbers;
        for (const auto& [rotation, translation] : poses) {
            quantised.add(translation, numbers);
            for (const double x : rotation.coeffs()) // x, y, z, w
                numbers.push_back(
                    static_cast<std::uint16_t>(std::lround(std::clamp(x, -1.0, 1.0) * 32767) + 32768));
        }
        json_["poses"].push_back(base64_of(numbers));
    }
}

void GeometryJson::write_contacts() {
    Eigen::AlignedBox3d box;
    std::size_t all = 0;
    std::size_t shown = 0;
    for (const auto& points : points_)
        for (const auto& point : points) box.extend(point);
    const Quantised quantised(box);
    const auto deepest = deepest_of(depths_);
    json_["deepest"] = deepest;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        std::vector<std::int8_t> normals;
        for (const auto& normal : normals_[i])
            for (const double x : normal)
                normals.push_back(static_cast<std::int8_t>(std::lround(std::clamp(x, -1.0, 1.0) * 127)));
        auto& contacts = json_["contacts"][i];
        contacts.update(points_json(points_[i], quantised));
        contacts["normals"] = base64_of(normals);
        contacts["depths"] = base64_of(scaled(depths_[i], deepest));
        all += contacts["found"].get<std::size_t>();
        shown += points_[i].size();
    }
    if (shown < all) notes_.push_back(fmt::format("{} of {} contacts are shown, evenly spaced", shown, all));
}

std::string GeometryJson::text() {
    json_["notes"] = notes_;
    return json_.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

} // namespace

} // namespace exporting

std::string geometry_json(const Scene& scene, std::span<const std::size_t> frames, const GeometryParts& parts,
                          const exporting::GeometryBudget& budget) {
    exporting::GeometryJson json(scene, frames, parts, budget);
    json.add_meshes();
    json.add_frames();
    return json.text();
}

void write_geometry(const std::string& path, const Scene& scene, std::span<const std::size_t> frames,
                    const GeometryParts& parts) {
    exporting::write_file(path, geometry_json(scene, frames, parts) + "\n");
}

} // namespace tandem
