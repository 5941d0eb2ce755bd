// SPDX-License-Identifier: MIT
#include "harness/flaws.h"

#include "harness/oracle/volume.h"
#include "scenes/error.h"
#include "scenes/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numeric>

namespace tandem {

namespace {

constexpr std::array names{"flat", "skip", "reject"};
constexpr std::size_t most_named = 4; ///< tetrahedra of a body, and bodies in a message

using Vertices = std::vector<Eigen::Vector3d>;

/// Ascending numbers of a body's tetrahedra in one frame.
struct Found {
    std::vector<std::uint32_t> degenerate, non_finite;

    bool any() const { return !degenerate.empty() || !non_finite.empty(); }
    std::vector<std::uint32_t> all() const {
        std::vector<std::uint32_t> both;
        std::merge(degenerate.begin(), degenerate.end(), non_finite.begin(), non_finite.end(),
                   std::back_inserter(both));
        return both;
    }
};

/// A stretch of tetrahedra, what a core takes at a time.
struct Stretch {
    const Vertices* vertices;
    const std::vector<Tetrahedron>* tetrahedra;
    std::size_t first;
    Found* target; ///< of all of them
    Found found;
};

constexpr std::size_t stretch_length = 4096;

void add_stretches(std::vector<Stretch>& stretches, const Vertices& vertices, const Mesh& mesh,
                   Found& target) {
    for (std::size_t first = 0; first < mesh.tetrahedra.size(); first += stretch_length)
        stretches.push_back({&vertices, &mesh.tetrahedra, first, &target, {}});
}

/// A tetrahedron is of one kind: with a coordinate that is not finite it has no volume to speak of.
void look_through(Stretch& stretch) {
    const auto end = std::min(stretch.tetrahedra->size(), stretch.first + stretch_length);
    for (auto t = stretch.first; t < end; ++t) {
        TetraCorners corners;
        bool finite = true;
        for (unsigned i = 0; i < 4; ++i) {
            const auto& v = (*stretch.vertices)[(*stretch.tetrahedra)[t][i]];
            finite = finite && v.allFinite();
            corners[i] = {v.x(), v.y(), v.z()};
        }
        if (!finite)
            stretch.found.non_finite.push_back(static_cast<std::uint32_t>(t));
        else if (!has_volume(corners))
            stretch.found.degenerate.push_back(static_cast<std::uint32_t>(t));
    }
}

void append(std::vector<std::uint32_t>& to, const std::vector<std::uint32_t>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

bool finite(const Pose& pose) { return pose.rotation.coeffs().allFinite() && pose.translation.allFinite(); }

/// What every body has in every frame.
class Search {
public:
    Search(const Scene& scene, std::span<const Frame> frames) : scene_(scene), frames_(frames) {
        rigid_.resize(scene.meshes.size());
        deformed_.resize(frames.size() * scene.bodies.size());
        std::vector<Stretch> stretches;
        for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh)
            add_stretches(stretches, scene.meshes[mesh].vertices, scene.meshes[mesh], rigid_[mesh]);
        for (std::size_t frame = 0; frame < frames.size(); ++frame)
            for (std::size_t body = 0; body < scene.bodies.size(); ++body)
                if (scene.bodies[body].deformable)
                    add_stretches(stretches, frames[frame].deformed[body], mesh_of(body),
                                  deformed_[frame * scene.bodies.size() + body]);
        parallel_for(stretches.size(), [&](std::size_t i) { look_through(stretches[i]); });
        for (const auto& stretch : stretches) {
            append(stretch.target->degenerate, stretch.found.degenerate);
            append(stretch.target->non_finite, stretch.found.non_finite);
        }
    }

    /// A rigid body has the flaws of its mesh, whatever its pose; one whose pose is not finite has no
    /// tetrahedron that is.
    Found found(std::size_t frame, std::size_t body) const {
        if (scene_.bodies[body].deformable) return deformed_[frame * scene_.bodies.size() + body];
        if (finite(frames_[frame].poses[body])) return rigid_[scene_.bodies[body].mesh];
        Found all;
        all.non_finite.resize(mesh_of(body).tetrahedra.size());
        std::iota(all.non_finite.begin(), all.non_finite.end(), 0u);
        return all;
    }

private:
    const Mesh& mesh_of(std::size_t body) const { return scene_.meshes[scene_.bodies[body].mesh]; }

    const Scene& scene_;
    std::span<const Frame> frames_;
    std::vector<Found> rigid_;    ///< by mesh
    std::vector<Found> deformed_; ///< [frame * bodies + body]
};

/// Adds one frame of a body; the first frame with any gives the examples.
void count(Flaws& flaws, FlawedBody& body, const Found& found, std::size_t frame) {
    if (!found.any()) return;
    if (body.degenerate + body.non_finite == 0) {
        body.frame = frame;
        body.first = found.all();
        if (body.first.size() > most_named) body.first.resize(most_named);
    }
    body.degenerate += found.degenerate.size();
    body.non_finite += found.non_finite.size();
    flaws.degenerate += found.degenerate.size();
    flaws.non_finite += found.non_finite.size();
}

/// Puts a finite vertex of the same body in the place of each that is not.
void make_finite(Vertices& vertices) {
    const auto good =
        std::find_if(vertices.begin(), vertices.end(), [](const auto& v) { return v.allFinite(); });
    const Eigen::Vector3d instead = good == vertices.end() ? Eigen::Vector3d::Zero() : *good;
    for (auto& v : vertices)
        if (!v.allFinite()) v = instead;
}

/// Counts of all frames; without `degenerate` those that are not finite only.
Flaws counted(const Search& search, const Scene& scene, std::size_t first, std::size_t frames,
              bool degenerate) {
    Flaws flaws;
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
        FlawedBody own;
        own.body = body;
        for (std::size_t i = 0; i < frames; ++i) {
            auto found = search.found(i, body);
            if (!degenerate) found.degenerate.clear();
            count(flaws, own, found, first + i);
        }
        if (!own.first.empty()) flaws.bodies.push_back(std::move(own));
    }
    return flaws;
}

/// Lists them as skipped and puts something finite in their place, which nothing looks at but arithmetic that
/// goes over whole bodies.
void leave_out(const Search& search, const Scene& scene, std::span<Frame> frames) {
    for (std::size_t i = 0; i < frames.size(); ++i)
        for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
            auto& frame = frames[i];
            if (const auto found = search.found(i, body); found.any()) {
                frame.skipped.resize(scene.bodies.size());
                frame.skipped[body] = found.all();
            }
            make_finite(frame.deformed[body]);
            if (!finite(frame.poses[body])) frame.poses[body] = {};
        }
}

} // namespace

std::string_view name_of(Degenerate handling) { return names[static_cast<std::size_t>(handling)]; }

Degenerate degenerate_named(const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        throw InputError(fmt::format("--degenerate {}: give flat, skip or reject", name));
    return static_cast<Degenerate>(found - names.begin());
}

Flaws handle_flaws(const Scene& scene, std::size_t first, std::span<Frame> frames, Degenerate handling) {
    const Search search(scene, frames);
    auto flaws = counted(search, scene, first, frames.size(), true);
    flaws.handling = handling;
    if (handling == Degenerate::flat && flaws.non_finite > 0)
        throw InputError(
            fmt::format("tetrahedra {}; repair the frames, or leave them out with --degenerate skip",
                        describe(counted(search, scene, first, frames.size(), false), scene)));
    if (handling == Degenerate::reject && flaws.any())
        throw InputError(
            fmt::format("--degenerate reject: tetrahedra {}; repair them, or choose flat or skip",
                        describe(flaws, scene)));
    if (handling == Degenerate::skip && flaws.any()) leave_out(search, scene, frames);
    return flaws;
}

std::string describe(const Flaws& flaws, const Scene& scene) {
    std::vector<std::string> places;
    for (const auto& body : flaws.bodies) {
        if (places.size() == most_named) break;
        const bool more = body.degenerate + body.non_finite > body.first.size();
        places.push_back(fmt::format("body {} tetrahedron {}{} in frame {}", body.body,
                                     fmt::join(body.first, ", "), more ? ", ..." : "", body.frame));
    }
    std::vector<std::string> counts;
    if (flaws.degenerate > 0) counts.push_back(fmt::format("{} of zero volume", flaws.degenerate));
    if (flaws.non_finite > 0) counts.push_back(fmt::format("{} not finite", flaws.non_finite));
    return fmt::format("{} in {} of {} bodies: {}{}", fmt::join(counts, " and "), flaws.bodies.size(),
                       scene.bodies.size(), fmt::join(places, "; "),
                       flaws.bodies.size() > most_named ? "; ..." : "");
}

} // namespace tandem
