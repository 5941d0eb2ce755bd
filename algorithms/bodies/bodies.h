// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "algorithms/hierarchy/order.h"
#include "scenes/scene.h"

namespace tandem {

/// A scene's bodies on one device: tetrahedra in a builder's order, vertices and poses. Whatever hierarchy
/// stands over them, item i of a body is its tetrahedron at position i.
class Bodies {
public:
    /// What bodies with one mesh have in common.
    enum class Sharing {
        by_mesh, ///< its tetrahedra and, but for deformable bodies, its vertices
        none     ///< nothing, and all vertices are in world coordinates: the published data path
    };

    /// A row of rows.clh: where a body's data begin, and flags.
    struct Row {
        std::uint32_t tetrahedra = 0, vertices = 0, tetrahedron_count = 0, flags = 0;
    };

    /// Uploads what is static; `scene` must outlive this. Throws DeviceError when there are more than 2^32
    /// vertices or tetrahedra, OutOfMemory when they do not fit.
    Bodies(Device& device, const Scene& scene, const Geometry& geometry, Sharing sharing,
           Builder builder = Builder::morton);

    /// Enqueues the upload of what `frame` moves: poses, and vertices of deformable bodies. `all`: also of
    /// what does not move, as the first frame needs it. For Sharing::by_mesh; the published data path uploads
    /// everything itself.
    void update(const Frame& frame, bool all = true);

    Device& device() const { return device_; }
    const Scene& scene() const { return scene_; }
    const Geometry& geometry() const { return geometry_; }
    std::uint32_t count() const { return static_cast<std::uint32_t>(rows_.size()); }
    const Row& row(std::size_t body) const { return rows_[body]; }
    /// The body's mesh as the device has it.
    const OrderedMesh& mesh(std::size_t body) const { return meshes_[scene_.bodies[body].mesh]; }
    /// By the scene's number of the mesh.
    const OrderedMesh& ordered_mesh(std::size_t number) const { return meshes_[number]; }
    /// Rows of vertices(): of meshes where they are shared, of bodies where not.
    std::uint64_t vertex_total() const { return vertex_total_; }
    /// Bytes of device memory in all buffers.
    std::size_t bytes() const;
    /// The rows of all bodies, and a frame's poses, as kernels read them.
    std::span<const std::byte> packed_rows() const { return bytes_of(rows_); }
    std::vector<std::byte> packed_poses(const Frame& frame) const;

    const Buffer& row_table() const { return row_table_; }   ///< BODY_WORDS words a body
    const Buffer& tetrahedra() const { return tetrahedra_; } ///< 4 vertex numbers each
    const Buffer& ids() const { return ids_; } ///< position -> tetrahedron in input order, a word each
    const Buffer& boundary() const { return boundary_; } ///< a byte each: bit i, the face opposite corner i
    const Buffer& vertices() const { return vertices_; } ///< 4 reals each
    const Buffer& poses() const { return poses_; }       ///< POSE_REALS reals a body

private:
    void lay_out();
    void upload_static();
    std::vector<std::byte> shared_vertices() const;
    std::array<double, 3> drift_of(const Frame& frame, std::size_t body) const;
    void upload_poses(const Frame& frame, bool all);
    void upload_deformed(const Frame& frame);
    bool has_own_vertices(std::size_t body) const;

    Device& device_;
    const Scene& scene_;
    Geometry geometry_;
    Sharing sharing_;
    std::vector<OrderedMesh> meshes_;
    std::vector<double> reaches_; ///< by mesh: reach_of; placement = exact only
    std::vector<Row> rows_;
    std::uint64_t vertex_total_ = 0;
    std::uint64_t deformed_vertices_ = 0; ///< of all bodies whose vertices change
    std::uint64_t tetrahedron_total_ = 0;
    Buffer row_table_, tetrahedra_, ids_, boundary_, vertices_, poses_;
};

/// positions[order[i]] = i.
std::vector<std::uint32_t> inverse(std::span<const std::uint32_t> order);

} // namespace tandem
