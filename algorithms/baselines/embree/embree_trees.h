// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/tile_trees.h"
#include "algorithms/pipeline/stages.h"

#if __has_include(<embree4/rtcore.h>) // the order in which CMake looks for them
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <tbb/task_arena.h>
#include <type_traits>

namespace tandem {

/// Maximum gap of slabs that overlap with rounding=published (PUBLISHED_TOLERANCE).
inline constexpr float published_tolerance = 10 * std::numeric_limits<float>::epsilon();

/// Embree's trees, one per body, over the leaf slabs that the project's own kernels make (k = 6: boxes). A
/// kernel of device host that is compiled C++ drives Embree, so that its work is recorded like any kernel's.
class EmbreeTrees final : public Hierarchy {
public:
    /// Slabs of a tetrahedron. Cells with equal slabs have equal pairs. The box of a skipped tetrahedron ends
    /// before it starts.
    struct Box {
        std::array<float, 3> lower, upper;
    };

    /// Throws DeviceError when Embree does not start.
    explicit EmbreeTrees(const BuildContext& context);

    const Bodies& bodies() const { return tiles_.bodies(); }
    /// The body's tree; null if all its tetrahedra are skipped.
    RTCScene scene(std::uint32_t body) const;
    /// By position in the builder's order.
    std::span<const Box> boxes(std::uint32_t body) const { return trees_[body].boxes; }
    /// Has as many threads as setting threads gives; Embree's own tasks stay on them.
    tbb::task_arena& arena() { return arena_; }
    /// Throws the first error that Embree reported since the last call: OutOfMemory or DeviceError.
    void check();

    /// Kernel refit_embree. `leaves`: those of the tiles.
    static void run(const float* leaves, EmbreeTrees* trees);

private:
    template<auto Release>
    struct Releaser {
        template<class Handle>
        void operator()(Handle* handle) const {
            Release(handle);
        }
    };
    template<class Handle, auto Release>
    using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Releaser<Release>>;
    using OwnedDevice = Owned<RTCDevice, rtcReleaseDevice>;
    using OwnedScene = Owned<RTCScene, rtcReleaseScene>;
    using OwnedGeometry = Owned<RTCGeometry, rtcReleaseGeometry>;

    struct Tree {
        float tolerance = 0; ///< maximum gap of boxes that overlap
        std::vector<Box> boxes;
        OwnedScene scene; ///< null before the first refit
        OwnedGeometry geometry;
        std::vector<std::uint32_t> skipped; ///< tetrahedra that the tree does not contain
    };

    void do_refit(const Frame& frame, bool all) override;
    const Buffer& do_volumes() const override { return tiles_.volumes(); }
    const Buffer& do_nodes() const override { return tiles_.nodes(); }
    std::size_t do_bytes() const override { return tiles_.bytes(); }

    static void give_bounds(const RTCBoundsFunctionArguments* arguments);
    static void store_error(void* trees, RTCError code, const char* text);
    void choose(const Frame& frame, bool all);
    void refit_body(std::uint32_t body, const float* leaves);
    void copy_boxes(std::uint32_t body, const float* leaves);
    void begin_tree(Tree& tree) const;

    Device& device_;
    TileTrees tiles_;
    std::mutex error_lock_;
    RTCError error_ = RTC_ERROR_NONE; ///< the first one
    std::string error_text_;
    OwnedDevice embree_;
    std::vector<Tree> trees_;
    std::vector<std::uint32_t> chosen_; ///< bodies of the current refit
    tbb::task_arena arena_;
    Kernel kernel_;
    Buffer self_; ///< this object, as an argument of the kernel
};

} // namespace tandem
