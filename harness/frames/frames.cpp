// SPDX-License-Identifier: MIT
#include "harness/frames/frames.h"

#include "algorithms/bodies/origin.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// The bytes of any frame of the scene, without lists of skipped tetrahedra.
std::uint64_t bytes_of_frame(const Scene& scene) {
    constexpr std::uint64_t lists =
        sizeof(decltype(Frame::deformed)::value_type) + sizeof(decltype(Frame::skipped)::value_type);
    auto bytes = sizeof(Frame) + scene.bodies.size() * (sizeof(Pose) + lists);
    for (const auto& body : scene.bodies)
        if (body.deformable) bytes += scene.meshes[body.mesh].vertices.size() * sizeof(Eigen::Vector3d);
    return bytes;
}

} // namespace

void check_frames(const Scene& scene, std::size_t first, std::size_t last) {
    if (first <= last && last < scene.frame_count) return;
    const auto message = fmt::format("frames {}:{} are impossible", first, last);
    if (first <= last && scene.dynamics)
        throw InputError(
            fmt::format("{}; scene {} moves by simulation and has its start only, frame 0: record it "
                        "with 'tandem simulate {} -o FILE.frames' and name FILE.frames",
                        message, scene.name, scene.name));
    if (first <= last && !scene.end.empty()) throw InputError(fmt::format("{}; {}", message, scene.end));
    throw InputError(fmt::format("{}; scene {} has frames 0:{}", message, scene.name, scene.frame_count - 1));
}

FrameRange::FrameRange(const Scene& scene, std::size_t first, std::size_t last, Degenerate handling,
                       std::uint64_t budget, bool has_successor)
    : scene_(scene), first_(first), last_(last), made_(size() + (has_successor ? 1 : 0)) {
    check_frames(scene, first, last);
    if (has_successor && last + 1 >= scene.frame_count)
        throw InputError(fmt::format(
            "frame {} of scene {} has no successor, which motion=linear needs; {}", last, scene.name,
            last > 0 ? fmt::format("end the frames at {}", last - 1) : "choose a scene that moves"));
    const auto bytes = bytes_of_frame(scene);
    FlawSearch search(scene, first);
    auto frames = search_flaws(search, std::clamp<std::uint64_t>(budget / bytes, 1, made_));
    flaws_ = search.flaws(handling);
    auto all_bytes = bytes * made_;
    if (handling == Degenerate::skip && flaws_.any()) {
        all_bytes += (flaws_.degenerate + flaws_.non_finite) * sizeof(Frame::skipped[0][0]);
        left_out_.emplace(std::move(search));
    }
    if (all_bytes > budget) return;
    stored_ = std::move(frames);
    if (left_out_)
        for (auto& frame : stored_) left_out_->leave_out(*frame);
}

/// Searches every frame for flaws, `most` frames at a time on all cores. Returns the last batch of frames.
FrameRange::Frames FrameRange::search_flaws(FlawSearch& search, std::size_t most) const {
    Frames frames;
    for (std::size_t begin = 0; begin < made_; begin += most) {
        frames.clear(); // frees memory before the next batch takes some
        for (auto i = begin; i < std::min(made_, begin + most); ++i)
            frames.push_back(std::make_shared<Frame>(scene_.frame(first_ + i)));
        search.add(frames);
    }
    return frames;
}

std::shared_ptr<Frame> FrameRange::make_frame(std::size_t index) const {
    auto frame = std::make_shared<Frame>(scene_.frame(first_ + index));
    if (left_out_) left_out_->leave_out(*frame);
    return frame;
}

std::shared_ptr<const Frame> FrameRange::frame(std::size_t index) const {
    if (!stored_.empty()) return stored_.at(index);
    const std::lock_guard lock(mutex_);
    if (recent_ && recent_index_ == index) return recent_;
    recent_.reset(); // frees memory before the next frame takes some
    recent_ = make_frame(index);
    recent_index_ = index;
    return recent_;
}

Eigen::Vector3d FrameRange::origin(Origin origin) const {
    if (origin == Origin::world) return Eigen::Vector3d::Zero();
    const std::lock_guard lock(mutex_);
    if (!origin_) origin_ = origin_of(scene_, origin); // makes frame 0
    return *origin_;
}

std::shared_ptr<const Frame> FrameRange::frame(std::size_t index, Origin origin) const {
    if (origin == Origin::world) return frame(index);
    return std::make_shared<const Frame>(counted_from(this->origin(origin), *frame(index)));
}

FrameState FrameRange::state(std::size_t index, Motion motion, Origin origin) const {
    FrameState state{frame(index, origin), nullptr};
    if (motion == Motion::none) return state;
    state.next = frame(index + 1, origin);
    if (state.frame->skipped == state.next->skipped) return state;
    const auto skipped = skipped_in_either(state.frame->skipped, state.next->skipped);
    for (auto* one : {&state.frame, &state.next}) {
        auto copy = std::make_shared<Frame>(**one);
        copy->skipped = skipped;
        *one = std::move(copy);
    }
    return state;
}

} // namespace tandem
