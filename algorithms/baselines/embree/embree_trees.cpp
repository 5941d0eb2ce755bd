// SPDX-License-Identifier: MIT
#include "algorithms/baselines/embree/embree_trees.h"

#include "algorithms/baselines/embree/native_kernel.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

namespace tandem {

namespace {

constexpr const char* refit_entry = "refit_embree";
[[maybe_unused]] const bool refit_listed = list_native<&EmbreeTrees::run>(refit_entry);

constexpr std::uint32_t lanes = TileShapes::lanes;
constexpr std::uint32_t box_words = 6;
/// Embree drops boxes that reach 1.844e18. All ends are clamped to the same value, so that no boxes come
/// apart.
constexpr float most_coordinate = 1e18f;
constexpr float least_normal = std::numeric_limits<float>::min();

/// Embree treats denormal numbers as zero in builds, but not in walks. It therefore gets none: boxes are
/// widened over them. Clamping and widening keep the order of any two ends, so that overlapping boxes still
/// overlap.
float end_for_embree(float end, float widened) {
    const auto cut = std::clamp(end, -most_coordinate, most_coordinate);
    return std::abs(cut) < least_normal ? widened : cut;
}

/// An upper end that is at least `tolerance` higher, whatever the rounding.
float raised(float end, float tolerance) {
    return tolerance > 0 ? std::nextafter(end + 2 * tolerance, std::numeric_limits<float>::max()) : end;
}

bool is_empty(const EmbreeTrees::Box& box) { return box.lower[0] > box.upper[0]; }

std::uint32_t concurrency_of(const Settings& settings) {
    const auto threads = static_cast<std::uint32_t>(settings[parameters::threads]);
    return threads == 0 ? static_cast<std::uint32_t>(tbb::info::default_concurrency()) : threads;
}

} // namespace

// Leaves of tiles have all 6 slabs with either choice of slabs; this choice has the host's fastest kernels.
EmbreeTrees::EmbreeTrees(const BuildContext& context)
    : device_(context.device),
      tiles_(context.bodies, Slabs::three, SelfPairs::off, context.shape.group_size, 1),
      embree_(rtcNewDevice(nullptr)),
      trees_(context.bodies.count()),
      arena_(static_cast<int>(concurrency_of(context.settings))),
      kernel_(compile_native(context.device, refit_entry)),
      self_(context.device.adopt(this, sizeof(*this), "Embree's trees")) {
    if (!embree_)
        throw DeviceError(fmt::format("host: Embree does not start (code {})",
                                      static_cast<int>(rtcGetDeviceError(nullptr))));
    rtcSetDeviceErrorFunction(embree_.get(), store_error, this);
    const bool tolerant = context.settings[parameters::rounding] == Rounding::published;
    for (std::uint32_t body = 0; body < trees_.size(); ++body) {
        trees_[body].tolerance = tolerant ? published_tolerance : 0;
        trees_[body].boxes.resize(context.bodies.row(body).tetrahedron_count);
    }
}

RTCScene EmbreeTrees::scene(std::uint32_t body) const {
    const auto& tree = trees_[body];
    return tree.skipped.size() < tree.boxes.size() ? tree.scene.get() : nullptr;
}

void EmbreeTrees::store_error(void* trees, RTCError code, const char* text) {
    auto& self = *static_cast<EmbreeTrees*>(trees);
    const std::lock_guard lock(self.error_lock_);
    if (self.error_ != RTC_ERROR_NONE) return;
    self.error_ = code;
    self.error_text_ = text ? text : "";
}

void EmbreeTrees::check() {
    const std::lock_guard lock(error_lock_);
    const auto code = std::exchange(error_, RTC_ERROR_NONE);
    if (code == RTC_ERROR_NONE) return;
    const auto text = fmt::format("host: Embree: {} (code {})", error_text_, static_cast<int>(code));
    if (code == RTC_ERROR_OUT_OF_MEMORY) throw OutOfMemory(text);
    throw DeviceError(text);
}

void EmbreeTrees::give_bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto& tree = *static_cast<const Tree*>(arguments->geometryUserPtr);
    auto box = tree.boxes[arguments->primID];
    if (!is_empty(box))
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.lower[axis] = end_for_embree(box.lower[axis], -least_normal);
            box.upper[axis] = end_for_embree(raised(box.upper[axis], tree.tolerance), least_normal);
        }
    const auto& [lower, upper] = box;
    *arguments->bounds_o = {lower[0], lower[1], lower[2], 0, upper[0], upper[1], upper[2], 0};
}

/// Each body has its own scene: low quality keeps one tree per geometry, and only such trees are refitted.
void EmbreeTrees::begin_tree(Tree& tree) const {
    tree.geometry.reset(rtcNewGeometry(embree_.get(), RTC_GEOMETRY_TYPE_USER));
    auto* geometry = tree.geometry.get();
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(tree.boxes.size()));
    rtcSetGeometryUserData(geometry, &tree);
    rtcSetGeometryBoundsFunction(geometry, give_bounds, nullptr);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    tree.scene.reset(rtcNewScene(embree_.get()));
    rtcSetSceneFlags(tree.scene.get(), RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(tree.scene.get(), RTC_BUILD_QUALITY_LOW);
    rtcAttachGeometry(tree.scene.get(), geometry);
}

/// Converts the lanes of tiles to consecutive boxes, which single leaf tests read.
void EmbreeTrees::copy_boxes(std::uint32_t body, const float* leaves) {
    auto& boxes = trees_[body].boxes;
    const auto* first = leaves + std::size_t{tiles_.first_tile(body, 0)} * (box_words * lanes);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, boxes.size(), 64 * lanes), [&](const auto& items) {
        for (auto item = items.begin(); item != items.end(); ++item) {
            const auto* words = first + item / lanes * (box_words * lanes) + item % lanes;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                boxes[item].lower[axis] = words[axis * lanes];
                boxes[item].upper[axis] = words[(3 + axis) * lanes];
            }
        }
    });
}

void EmbreeTrees::refit_body(std::uint32_t body, const float* leaves) {
    auto& tree = trees_[body];
    copy_boxes(body, leaves);
    if (!tree.scene) begin_tree(tree);
    rtcCommitGeometry(tree.geometry.get());
    rtcCommitScene(tree.scene.get());
}

void EmbreeTrees::run(const float* leaves, EmbreeTrees* trees) {
    const auto& chosen = trees->chosen_;
    trees->arena_.execute([&] {
        tbb::parallel_for(std::size_t{0}, chosen.size(),
                          [&](std::size_t i) { trees->refit_body(chosen[i], leaves); });
    });
    try {
        trees->check();
    } catch (const DeviceError&) { // trees may be incomplete
        for (const auto body : chosen) trees->trees_[body].scene.reset();
        throw;
    }
}

/// Selects bodies that move or that skip other tetrahedra than before. Trees of the latter are built again,
/// because a refit keeps the primitives of a tree.
void EmbreeTrees::choose(const Frame& frame, bool all) {
    chosen_.clear();
    for (std::uint32_t body = 0; body < trees_.size(); ++body) {
        auto& tree = trees_[body];
        const auto skipped = frame.skipped.empty() ? std::vector<std::uint32_t>{}
                                                   : bodies().positions_of(body, frame.skipped[body]);
        if (skipped != tree.skipped) {
            tree.skipped = skipped;
            tree.scene.reset();
        }
        const bool has_tetrahedra = tree.skipped.size() < tree.boxes.size();
        if (has_tetrahedra && (all || !tree.scene || !bodies().scene().bodies[body].fixed))
            chosen_.push_back(body);
    }
}

void EmbreeTrees::do_refit(const Frame& frame, bool all) {
    tiles_.refit(frame, all);
    choose(frame, all);
    if (chosen_.empty()) return;
    const StageScope scope(device_, Stage::refit);
    const std::array<Argument, 2> arguments{tiles_.leaves(), self_};
    device_.launch(kernel_, {1, 1}, arguments);
}

} // namespace tandem
