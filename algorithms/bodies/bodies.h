// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/frame_input.h"
#include "algorithms/bounds/geometry.h"
#include "algorithms/orders/order.h"
#include "algorithms/bodies/subdomain.h"
#include "scenes/scene.h"
#include "backends/lanes.h"

namespace tandem {

/// A scene's bodies on one device: tetrahedra in a builder's order, vertices and poses. For every hierarchy,
/// item i of a body is its tetrahedron at position i of that order.
class Bodies {
public:
    /// Data that bodies with the same mesh share.
    enum class Sharing {
        by_mesh, ///< tetrahedra, and vertices of bodies that are not deformable
        none     ///< nothing; all vertices are in world coordinates, as in the published data path
    };

    /// A row of rows.clh: first indices of a body's data, and flags.
    struct BodyRow {
        std::uint32_t tetrahedra = 0, vertices = 0, tetrahedron_count = 0, flags = 0;
    };

    /// The tetrahedron of a slot: its body, and its position in that body's order.
    struct SlotOwner {
        std::uint32_t body = 0, item = 0;
    };

    /// Slots in a block. The tetrahedra of a body start at the begin of a block.
    static constexpr std::uint32_t block_slots = TANDEM_LANES;

    /// Uploads constant data. `scene` must outlive this. `pair_layout` is a request; see pair_layout().
    /// Throws DeviceError for more than 2^32 vertices or tetrahedra, OutOfMemory if they do not fit.
    Bodies(Device& device, const Scene& scene, const Geometry& geometry, Sharing sharing,
           MeshOrder order = {}, PairLayout pair_layout = PairLayout::slots);

    /// Enqueues the upload of a frame's poses, and vertices of deformable bodies; with motion=linear also
    /// those of its successor. `all`: also if no rigid body moves, as the first frame needs it. For
    /// Sharing::by_mesh; the published data path has its own uploads.
    void update(const FrameInput& input, bool all = true);
    /// The two halves of update(). `waits`: wait for the upload of the vertices.
    void update_poses(const FrameInput& input, bool all);
    /// Whether update_poses() uploads anything.
    bool changes_poses(bool all) const;
    void update_deformed(const FrameInput& input, bool waits = false);
    /// From the next frame on, reads and uploads only bodies of this subdomain.
    void set_subdomain(const Subdomain& subdomain);
    /// From the next frame on, update() skips the vertices of these deformable bodies, which other code
    /// writes.
    void exclude_from_upload(std::span<const std::uint32_t> bodies);

    Device& device() const { return device_; }
    const Scene& scene() const { return scene_; }
    const Geometry& geometry() const { return geometry_; }
    Sharing sharing() const { return sharing_; }
    std::uint32_t count() const { return static_cast<std::uint32_t>(rows_.size()); }
    const BodyRow& row(std::size_t body) const { return rows_[body]; }
    /// The body's mesh in the order of the device.
    const OrderedMesh& mesh(std::size_t body) const { return meshes_[scene_.bodies[body].mesh]; }
    /// The same by the number of the mesh in the scene.
    const OrderedMesh& ordered_mesh(std::size_t number) const { return meshes_[number]; }
    /// Position of a tetrahedron of the body's mesh in the order of the device; OrderedMesh::unused if it is
    /// not walked.
    std::uint32_t position_of(std::size_t body, std::uint32_t tetrahedron) const;
    /// Positions of those of these tetrahedra that are walked.
    std::vector<std::uint32_t> positions_of(std::size_t body,
                                            std::span<const std::uint32_t> tetrahedra) const;
    /// Number of rows in vertices(): of meshes if they are shared, of bodies if not.
    std::uint64_t vertex_total() const { return vertex_total_; }
    /// Format of candidate pairs: items if slots are not requested, exceed 2^32, or with Sharing::none.
    PairLayout pair_layout() const { return pair_layout_; }
    /// All bodies in the order of their slots: moving bodies, then fixed ones.
    const std::vector<std::uint32_t>& slot_order() const { return slot_order_; }
    /// The slot of the body's first tetrahedron; 0 for PairLayout::items.
    std::uint32_t first_slot(std::size_t body) const;
    /// The tetrahedron of a slot; requires PairLayout::slots.
    SlotOwner slot_owner(std::uint32_t slot) const;
    /// Bytes of device memory in all buffers.
    std::size_t bytes() const;
    /// The rows of all bodies, and a frame's poses, in the format of kernels.
    std::span<const std::byte> packed_rows() const { return bytes_of(rows_); }
    std::vector<std::byte> packed_poses(const Frame& frame) const { return packed_poses(frame, {}); }

    /// The pressure of each vertex of a mesh, in its input order: of a mesh without a field -1, which no
    /// pressure of a field equals. Empty unless vertices carry pressures.
    std::span<const double> pressures(std::size_t mesh) const;

    const Buffer& row_table() const { return row_table_; } ///< BODY_WORDS words a body
    /// The table that members_of (pairs.clh) reads: rows of blocks of slots, or row_table().
    const Buffer& owners() const { return pair_layout_ == PairLayout::slots ? blocks_ : row_table_; }
    const Buffer& tetrahedra() const { return tetrahedra_; } ///< 4 vertex numbers each
    /// The same by OrderedMesh::topology(), to compare vertices within a body; of no meaning for coordinates.
    const Buffer& topology() const { return topology_ ? topology_ : tetrahedra_; }
    const Buffer& ids() const { return ids_; } ///< numbers of bodies and tetrahedra in answers (pairs.clh)
    const Buffer& boundary() const { return boundary_; } ///< 1 byte each; bit i: the face opposite corner i
    const Buffer& vertices() const { return vertices_; } ///< 4 reals each
    const Buffer& poses() const { return poses_; }       ///< POSE_REALS reals a body
    /// The same of the frame's successor; with motion=none the same buffers, which kernels do not read.
    const Buffer& next_vertices() const { return next_vertices_ ? next_vertices_ : vertices_; }
    const Buffer& next_poses() const { return next_poses_ ? next_poses_ : poses_; }

private:
    void lay_out();
    void lay_out_slots();
    std::vector<BodyRow> block_rows() const;
    void upload_static();
    std::vector<std::byte> shared_vertices() const;
    std::vector<std::byte> packed_poses(const Frame& frame, std::span<const double> arcs) const;
    std::vector<double> arcs_of(const FrameInput& input) const;
    void upload_deformed(const Frame& frame, const Buffer& vertices, bool waits);
    std::array<double, 3> drift_of(const Frame& frame, std::size_t body) const;
    void plan_runs();
    bool needs(std::size_t body) const { return roles_.empty() || roles_[body] != Role::none; }
    bool has_own_vertices(std::size_t body) const;

    Device& device_;
    const Scene& scene_;
    Geometry geometry_;
    Sharing sharing_;
    std::vector<OrderedMesh> meshes_;
    /// By mesh: tetrahedron -> position, or OrderedMesh::unused; computed on first use.
    mutable std::vector<std::vector<std::uint32_t>> positions_;
    std::vector<double> mesh_reaches_; ///< by mesh: reach_of; with placement=exact only
    std::vector<double> no_pressures_; ///< for the largest mesh without a field
    std::vector<BodyRow> rows_;
    PairLayout pair_layout_;
    std::vector<std::uint32_t> slot_order_;
    std::vector<std::uint64_t> first_blocks_; ///< in slot_order(), followed by the number of all blocks
    std::uint64_t vertex_total_ = 0;
    std::uint64_t tetrahedron_total_ = 0;
    std::vector<Role> roles_;       ///< by body; empty: all bodies are needed
    std::vector<bool> is_excluded_; ///< by body, from update(); empty: none
    /// Deformable bodies whose vertices are uploaded together, and their rows in vertices().
    struct Run {
        std::uint64_t first = 0, end = 0;
        std::vector<std::uint32_t> bodies;
    };
    std::vector<Run> runs_;
    Buffer row_table_, blocks_, tetrahedra_, topology_, ids_, boundary_, vertices_, poses_, next_vertices_,
        next_poses_;
};

} // namespace tandem
