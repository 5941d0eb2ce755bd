// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/kdop/emptied.h"
#include "algorithms/kdop/kdop_settings.h"
#include "algorithms/kdop/strips.h"
#include "algorithms/kdop/tree.h"
#include "scenes/scene.h"

namespace tandem {

/// Two bodies whose volumes may overlap; a < b.
struct BodyPair {
    std::uint32_t a = 0;
    std::uint32_t b = 0;

    auto operator<=>(const BodyPair&) const = default;
};

/// Where the data of a frame lives between frames.
enum class Residency {
    resident, ///< topology once, shared by bodies with one mesh; a frame uploads poses or vertices only
    published ///< as the paper's code: everything converted, uploaded and read back in every frame
};

/// A scene's hierarchies on one device: built once, transformed and refitted every frame.
class DeviceScene {
public:
    /// `leaves`: tetrahedra per chunk, a power of two. Uploads what is static and compiles. Throws
    /// DeviceError when the scene does not fit.
    DeviceScene(Device& device, const Scene& scene, const Geometry& geometry, std::uint32_t leaves,
                std::uint32_t group_size, Residency residency);

    /// Enqueues upload, transform and refit of a frame. Tetrahedra that it skips are in no node; the kernel
    /// for that is compiled with the first such frame.
    void update(const Frame& frame);

    Device& device() const { return device_; }
    const Geometry& geometry() const { return geometry_; }
    std::uint32_t group_size() const { return group_size_; }
    std::uint32_t leaves() const { return leaves_; }
    std::uint32_t body_count() const { return static_cast<std::uint32_t>(body_rows_.size() / 8); }
    /// Levels of each body's hierarchy.
    const std::vector<Level>& levels(std::uint32_t body) const {
        return mesh_levels_[scene_.bodies[body].mesh];
    }
    /// Position in Morton order -> tetrahedron in input order.
    const std::vector<std::uint32_t>& ids(std::uint32_t body) const {
        return meshes_[scene_.bodies[body].mesh].ids;
    }
    /// Node slots of all bodies.
    std::uint64_t slots() const { return slots_; }

    /// Rows of BODY_WORDS words as node.clh lists them, for seeds made on the host.
    const std::vector<std::uint32_t>& body_rows() const { return body_rows_; }

    const Buffer& nodes() const { return nodes_; }
    const Buffer& bodies() const { return bodies_; }
    const Buffer& level_table() const { return levels_; }
    const Buffer& tetrahedra() const { return tetrahedra_; }
    const Buffer& tetrahedron_ids() const { return ids_; }
    const Buffer& boundary() const { return boundary_; }
    const Buffer& vertices() const { return vertices_; }
    const Buffer& poses() const { return poses_; }

private:
    struct Strip {
        std::uint32_t level, height, first_job, jobs, dynamic_jobs;
    };

    Kernel compile(std::string_view entry) const;
    void lay_out();
    void plan_strips();
    void plan_strip(std::uint32_t level, bool fixed, std::uint32_t top);
    void upload_static();
    std::vector<std::byte> shared_vertices() const;
    std::array<double, 3> drift_of(const Frame& frame, std::size_t body) const;
    void pack_poses(std::vector<std::byte>& bytes, const Frame& frame) const;
    void upload_poses(const Frame& frame);
    void upload_deformed(const Frame& frame);
    void leave_out(const Frame& frame);
    void upload_emptied();
    void refit(bool all);
    void update_published(const Frame& frame);
    bool in_world(std::size_t body) const;
    std::size_t vertices_of(std::size_t body) const;

    Device& device_;
    const Scene& scene_;
    Geometry geometry_;
    std::uint32_t leaves_;
    std::uint32_t group_size_;
    RefitShape refit_shape_;
    Residency residency_;
    std::vector<OrderedMesh> meshes_;
    std::vector<double> reaches_; ///< by mesh: reach_of; truth = pose only
    std::vector<std::vector<Level>> mesh_levels_;
    std::vector<std::uint32_t> body_rows_;
    std::vector<std::uint32_t> level_rows_;
    std::vector<std::uint32_t> jobs_;
    std::vector<Strip> strips_;
    std::uint32_t first_top_level_ = 1; ///< the first level that refit_tops does
    std::uint32_t moving_bodies_ = 0;   ///< how many in body_order_ are not fixed; they come first
    std::uint64_t slots_ = 0;
    std::uint64_t vertex_total_ = 0;
    std::uint64_t tetrahedron_total_ = 0;
    bool fresh_ = true; ///< fixed bodies need a refit: there was no frame yet, or it skipped others of theirs
    std::vector<std::vector<std::uint32_t>> skipped_; ///< by the last frame
    std::vector<std::vector<std::uint32_t>>
        positions_;   ///< by mesh: the inverse of its ids, once it is needed
    Emptied emptied_; ///< for skipped_
    Buffer nodes_, bodies_, levels_, tetrahedra_, ids_, boundary_, vertices_, poses_, job_table_, body_order_;
    Buffer local_vertices_, vertex_bodies_; ///< published: vertices before the transform, and whose they are
    Buffer emptied_rows_, emptied_starts_;
    Kernel strips_kernel_, tops_kernel_, transform_kernel_, empty_kernel_;
};

} // namespace tandem
