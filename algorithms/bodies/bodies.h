// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "algorithms/hierarchy/order.h"
#include "algorithms/distributed/subdomain.h"
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
    struct BodyRow {
        std::uint32_t tetrahedra = 0, vertices = 0, tetrahedron_count = 0, flags = 0;
    };

    /// A tetrahedron: its body, and its position in that body's order.
    struct SlotOwner {
        std::uint32_t body = 0, item = 0;
    };

    /// Slots of a block: a body's tetrahedra begin with a block.
    static constexpr std::uint32_t block_slots = 32;

    /// Uploads what is static; `scene` must outlive this. `pair_layout`: what is wanted; see pair_layout().
    /// Throws DeviceError when there are more than 2^32 vertices or tetrahedra, OutOfMemory when they do not
    /// fit.
    Bodies(Device& device, const Scene& scene, const Geometry& geometry, Sharing sharing,
           Builder builder = Builder::morton, PairLayout pair_layout = PairLayout::slots);

    /// Enqueues the upload of what `frame` moves: poses, and vertices of deformable bodies. `all`: also of
    /// what does not move, as the first frame needs it. For Sharing::by_mesh; the published data path uploads
    /// everything itself.
    void update(const Frame& frame, bool all = true);
    /// The two halves of update(); `waits`: until vertices are there.
    void update_poses(const Frame& frame, bool all);
    void update_deformed(const Frame& frame, bool waits = false);
    /// From now on only what has a part in `share` is looked at in a frame and uploaded.
    void take(const Subdomain& share);
    /// From now on update() leaves out the vertices of these deformable bodies, which somebody else writes.
    void leave(std::span<const std::uint32_t> bodies);

    Device& device() const { return device_; }
    const Scene& scene() const { return scene_; }
    const Geometry& geometry() const { return geometry_; }
    std::uint32_t count() const { return static_cast<std::uint32_t>(rows_.size()); }
    const BodyRow& row(std::size_t body) const { return rows_[body]; }
    /// The body's mesh as the device has it.
    const OrderedMesh& mesh(std::size_t body) const { return meshes_[scene_.bodies[body].mesh]; }
    /// By the scene's number of the mesh.
    const OrderedMesh& ordered_mesh(std::size_t number) const { return meshes_[number]; }
    /// Rows of vertices(): of meshes where they are shared, of bodies where not.
    std::uint64_t vertex_total() const { return vertex_total_; }
    /// How candidate pairs name tetrahedra: items where slots were not asked for, where there are more than
    /// 2^32 of them, and for Sharing::none.
    PairLayout pair_layout() const { return pair_layout_; }
    /// All bodies in the order of their slots: those that move, then the fixed ones.
    const std::vector<std::uint32_t>& slot_order() const { return slot_order_; }
    /// Of its tetrahedra; 0 for PairLayout::items.
    std::uint32_t first_slot(std::size_t body) const;
    /// Whose a slot is; of PairLayout::slots.
    SlotOwner slot_owner(std::uint32_t slot) const;
    /// Bytes of device memory in all buffers.
    std::size_t bytes() const;
    /// The rows of all bodies, and a frame's poses, as kernels read them.
    std::span<const std::byte> packed_rows() const { return bytes_of(rows_); }
    std::vector<std::byte> packed_poses(const Frame& frame) const;

    const Buffer& row_table() const { return row_table_; } ///< BODY_WORDS words a body
    /// What members_of (pairs.clh) finds tetrahedra by: rows of blocks of slots, or row_table().
    const Buffer& owners() const { return pair_layout_ == PairLayout::slots ? blocks_ : row_table_; }
    const Buffer& tetrahedra() const { return tetrahedra_; } ///< 4 vertex numbers each
    const Buffer& ids() const { return ids_; } ///< how answers name bodies and tetrahedra (pairs.clh)
    const Buffer& boundary() const { return boundary_; } ///< a byte each: bit i, the face opposite corner i
    const Buffer& vertices() const { return vertices_; } ///< 4 reals each
    const Buffer& poses() const { return poses_; }       ///< POSE_REALS reals a body

private:
    void lay_out();
    void lay_out_slots();
    std::vector<BodyRow> block_rows() const;
    void upload_static();
    std::vector<std::byte> shared_vertices() const;
    std::array<double, 3> drift_of(const Frame& frame, std::size_t body) const;
    void plan_runs();
    bool takes(std::size_t body) const { return roles_.empty() || roles_[body] != Role::none; }
    bool has_own_vertices(std::size_t body) const;

    Device& device_;
    const Scene& scene_;
    Geometry geometry_;
    Sharing sharing_;
    std::vector<OrderedMesh> meshes_;
    std::vector<double> is_gpu_aware_; ///< by mesh: reach_of; placement = exact only
    std::vector<BodyRow> rows_;
    PairLayout pair_layout_;
    std::vector<std::uint32_t> slot_order_;
    std::vector<std::uint64_t> first_blocks_; ///< in slot_order(), and the number of all behind them
    std::uint64_t vertex_total_ = 0;
    std::uint64_t tetrahedron_total_ = 0;
    std::vector<Role> roles_; ///< by body; none where all take part
    std::vector<bool> left_;  ///< by body, whose vertices somebody else writes; none where nobody does
    /// Deformable bodies whose vertices are uploaded together, and the rows of vertices() that they fill.
    struct Run {
        std::uint64_t first = 0, end = 0;
        std::vector<std::uint32_t> bodies;
    };
    std::vector<Run> runs_;
    Buffer row_table_, blocks_, tetrahedra_, ids_, boundary_, vertices_, poses_;
};

/// positions[order[i]] = i.
std::vector<std::uint32_t> inverse(std::span<const std::uint32_t> order);

} // namespace tandem
