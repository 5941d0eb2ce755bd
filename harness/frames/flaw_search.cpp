// SPDX-License-Identifier: MIT
#include "harness/frames/flaw_search.h"

#include "geometry/volume.h"
#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace tandem {

namespace {

using Vertices = std::vector<Eigen::Vector3d>;

/// A block of tetrahedra for one parallel task.
struct Block {
    const Vertices* vertices;
    const std::vector<Tetrahedron>* tetrahedra;
    std::size_t first;
    FlawedTetrahedra* target; ///< the result for all blocks of the body or mesh
    FlawedTetrahedra found;
};

constexpr std::size_t block_length = 4096;

void add_blocks(std::vector<Block>& blocks, const Vertices& vertices, const Mesh& mesh,
                FlawedTetrahedra& target) {
    for (std::size_t first = 0; first < mesh.tetrahedra.size(); first += block_length)
        blocks.push_back({&vertices, &mesh.tetrahedra, first, &target, {}});
}

/// A tetrahedron counts once: one with a coordinate that is not finite is not tested for zero volume.
void search_block(Block& block) {
    const auto end = std::min(block.tetrahedra->size(), block.first + block_length);
    for (auto t = block.first; t < end; ++t) {
        TetraCorners corners;
        bool finite = true;
        for (unsigned i = 0; i < 4; ++i) {
            const auto& v = (*block.vertices)[(*block.tetrahedra)[t][i]];
            finite = finite && v.allFinite();
            corners[i] = {v.x(), v.y(), v.z()};
        }
        if (!finite)
            block.found.non_finite.push_back(static_cast<std::uint32_t>(t));
        else if (!has_volume(corners))
            block.found.degenerate.push_back(static_cast<std::uint32_t>(t));
    }
}

void append(std::vector<std::uint32_t>& to, const std::vector<std::uint32_t>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

bool finite(const Pose& pose) { return pose.rotation.coeffs().allFinite() && pose.translation.allFinite(); }

/// Adds the flaws of a body in one frame; the examples come from its first flawed frame.
void count(Flaws& flaws, std::size_t body, const FlawedTetrahedra& found, std::size_t frame) {
    if (!found.any()) return;
    auto& entry = flaws.bodies[body];
    if (entry.degenerate + entry.non_finite == 0) {
        entry.frame = frame;
        entry.first = found.all();
        if (entry.first.size() > most_named_flaws) entry.first.resize(most_named_flaws);
    }
    entry.degenerate += found.degenerate.size();
    entry.non_finite += found.non_finite.size();
    flaws.degenerate += found.degenerate.size();
    flaws.non_finite += found.non_finite.size();
}

/// Removes bodies without flaws.
Flaws only_flawed(Flaws flaws) {
    std::erase_if(flaws.bodies, [](const auto& body) { return body.first.empty(); });
    return flaws;
}

/// Replaces vertices that are not finite by a finite one of the same body.
void make_finite(Vertices& vertices) {
    const auto good =
        std::find_if(vertices.begin(), vertices.end(), [](const auto& v) { return v.allFinite(); });
    const Eigen::Vector3d instead = good == vertices.end() ? Eigen::Vector3d::Zero() : *good;
    for (auto& v : vertices)
        if (!v.allFinite()) v = instead;
}

void search(std::vector<Block>& blocks) {
    parallel_for(blocks.size(), [&](std::size_t i) { search_block(blocks[i]); });
    for (const auto& block : blocks) {
        append(block.target->degenerate, block.found.degenerate);
        append(block.target->non_finite, block.found.non_finite);
    }
}

} // namespace

std::vector<std::uint32_t> FlawedTetrahedra::all() const {
    std::vector<std::uint32_t> both;
    std::merge(degenerate.begin(), degenerate.end(), non_finite.begin(), non_finite.end(),
               std::back_inserter(both));
    return both;
}

FlawSearch::FlawSearch(const Scene& scene, std::size_t first)
    : scene_(scene), next_(first), rigid_(scene.meshes.size()) {
    std::vector<Block> blocks;
    for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh)
        add_blocks(blocks, scene.meshes[mesh].vertices, scene.meshes[mesh], rigid_[mesh]);
    search(blocks);
    all_.bodies.resize(scene.bodies.size());
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) all_.bodies[body].body = body;
    non_finite_ = all_;
}

const Mesh& FlawSearch::mesh_of(std::size_t body) const { return scene_.meshes[scene_.bodies[body].mesh]; }

/// The flaws of deformable bodies; empty for rigid ones.
FlawSearch::Found FlawSearch::deformed(std::span<const Frame* const> frames) const {
    const auto bodies = scene_.bodies.size();
    Found found(frames.size() * bodies);
    std::vector<Block> blocks;
    for (std::size_t i = 0; i < found.size(); ++i)
        if (scene_.bodies[i % bodies].deformable)
            add_blocks(blocks, frames[i / bodies]->deformed[i % bodies], mesh_of(i % bodies), found[i]);
    search(blocks);
    return found;
}

/// A rigid body has the flaws of its mesh. With a pose that is not finite, none of its tetrahedra is finite.
FlawedTetrahedra FlawSearch::flaws_of(const Frame& frame, std::size_t body,
                                      const FlawedTetrahedra& deformed) const {
    if (scene_.bodies[body].deformable) return deformed;
    if (finite(frame.poses[body])) return rigid_[scene_.bodies[body].mesh];
    FlawedTetrahedra all;
    all.non_finite.resize(mesh_of(body).tetrahedra.size());
    std::iota(all.non_finite.begin(), all.non_finite.end(), 0u);
    return all;
}

void FlawSearch::add(std::span<const std::shared_ptr<Frame>> frames) {
    std::vector<const Frame*> pointers;
    for (const auto& frame : frames) pointers.push_back(frame.get());
    const auto of_deformable = deformed(pointers);
    for (std::size_t i = 0; i < of_deformable.size(); ++i) {
        const auto frame = i / scene_.bodies.size(), body = i % scene_.bodies.size();
        auto found = flaws_of(*frames[frame], body, of_deformable[i]);
        count(all_, body, found, next_ + frame);
        found.degenerate.clear();
        count(non_finite_, body, found, next_ + frame);
    }
    next_ += frames.size();
}

Flaws FlawSearch::flaws(Degenerate handling) const {
    auto flaws = only_flawed(all_);
    flaws.handling = handling;
    if (handling == Degenerate::flat && flaws.non_finite > 0)
        throw InputError(
            fmt::format("tetrahedra {}; repair the frames, or leave them out with --degenerate skip",
                        describe(only_flawed(non_finite_), scene_)));
    if (handling == Degenerate::reject && flaws.any())
        throw InputError(
            fmt::format("--degenerate reject: tetrahedra {}; repair them, or choose flat or skip",
                        describe(flaws, scene_)));
    return flaws;
}

void FlawSearch::leave_out(Frame& frame) const {
    const Frame* const pointer = &frame;
    const auto of_deformable = deformed({&pointer, 1});
    for (std::size_t body = 0; body < of_deformable.size(); ++body) {
        if (const auto found = flaws_of(frame, body, of_deformable[body]); found.any()) {
            frame.skipped.resize(scene_.bodies.size());
            frame.skipped[body] = found.all();
        }
        make_finite(frame.deformed[body]);
        if (!finite(frame.poses[body])) frame.poses[body] = {};
    }
}

} // namespace tandem
