// SPDX-License-Identifier: MIT
#include "algorithms/bodies/pose_stage.h"

#include "algorithms/kernels/sources.h"
#include "backends/upload.h"
#include "base/parallel.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::size_t numbers_per_pose = 7; ///< POSE_NUMBERS
/// Bodies that a processor packs in about the time of a launch.
constexpr std::uint32_t few_bodies = 256;

} // namespace

std::unique_ptr<PoseStage> PoseStage::make(const Bodies& bodies, LaunchShape shape) {
    const auto& info = bodies.device().info();
    const bool host_packs = info.id == "host" || bodies.count() < few_bodies || !info.has_double
                            || bodies.geometry().placement == Placement::exact
                            || bodies.geometry().motion == Motion::linear
                            || bodies.sharing() == Bodies::Sharing::none;
    if (host_packs) return nullptr;
    try {
        return std::unique_ptr<PoseStage>(new PoseStage(bodies, shape));
    } catch (const OutOfMemory&) {
        return nullptr;
    }
}

PoseStage::PoseStage(const Bodies& bodies, LaunchShape shape)
    : bodies_(bodies),
      grid_{std::clamp<std::uint64_t>((bodies.count() + shape.group_size - 1) / shape.group_size, 1,
                                      shape.groups),
            shape.group_size},
      numbers_(numbers_per_pose * bodies.count()),
      rows_(bodies.device().allocate(numbers_.size() * sizeof(double), "poses of the host")) {
    compile_kernel(bodies.device(), kernel_, row_defines(bodies.geometry(), shape.group_size));
}

void PoseStage::launch(const Frame& frame, bool all) {
    if (!bodies_.changes_poses(all)) return;
    auto& device = bodies_.device();
    {
        const HostWork work(device, Stage::preprocess, "copy poses");
        const auto copy = [&](std::size_t begin, std::size_t end) {
            auto* to = numbers_.data() + numbers_per_pose * begin;
            for (auto body = begin; body < end; ++body) {
                const auto& [q, t] = frame.poses[body];
                for (const double number : {t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()}) *to++ = number;
            }
        };
        const auto bodies = frame.poses.size();
        constexpr std::size_t part =
            4096; // bodies that a processor copies in a few times the start of a loop
        if (bodies <= part)
            copy(0, bodies);
        else
            parallel_for((bodies + part - 1) / part,
                         [&](std::size_t i) { copy(i * part, std::min(bodies, (i + 1) * part)); });
    }
    {
        const StageScope scope(device, Stage::write);
        device.upload(rows_, bytes_of(numbers_));
    }
    const StageScope scope(device, Stage::preprocess);
    const kernels::pack_frame::PackUnitPoses arguments{
        .poses = bodies_.poses(), .rows = rows_, .count = bodies_.count()};
    device.launch(kernel_, grid_, arguments);
}

} // namespace tandem
