// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/frame_input.h"
#include "algorithms/parameters/choices.h"
#include "harness/frames/flaw_search.h"

#include <memory>
#include <mutex>
#include <optional>

namespace tandem {

/// Memory for the frames of a range, in bytes. Scripted scenes and recordings of a few million vertices fit
/// and are replayed from memory; long recordings of deformable bodies do not. A machine with 4 GiB still has
/// enough memory for the scene, its reference and its truth.
inline constexpr std::uint64_t frame_budget = std::uint64_t{1} << 30;

/// Throws InputError that names the reason when the scene does not have these frames.
void check_frames(const Scene& scene, std::size_t first, std::size_t last);

/// A frame of a range, and its successor where a cell bounds motion.
struct FrameState {
    std::shared_ptr<const Frame> frame, next; ///< next: null with motion=none
    FrameInput input() const { return {*frame, next.get()}; }
};

/// Frames FIRST..LAST of a scene with their flaws handled. All are stored when they fit the budget. Otherwise
/// only the last requested frame is stored, and another frame is made on request by Scene::frame and
/// FlawSearch::leave_out, which takes the time to read and check it. Thread-safe.
class FrameRange {
public:
    /// Makes every frame once and handles flaws, with at most `budget` bytes of frames, or one frame, in
    /// memory. Throws InputError when frames do not exist or cannot be read, or when `handling` refuses a
    /// flaw. The scene must outlive this object and must not move. `has_successor`: whether the frame after
    /// LAST is made, too, as the successor of LAST.
    FrameRange(const Scene& scene, std::size_t first, std::size_t last,
               Degenerate handling = Degenerate::flat, std::uint64_t budget = frame_budget,
               bool has_successor = false);
    FrameRange(const FrameRange&) = delete;
    FrameRange& operator=(const FrameRange&) = delete;

    std::size_t first() const { return first_; }
    std::size_t last() const { return last_; }
    std::size_t size() const { return last_ - first_ + 1; }
    /// The flaws of all frames, and how they were handled.
    const Flaws& flaws() const { return flaws_; }
    /// Frame first() + index, which does not change while the caller keeps it. Do not call this in a timed
    /// span. Throws InputError when a recording can no longer be read.
    std::shared_ptr<const Frame> frame(std::size_t index) const;
    /// The origin of the scene's sessions with that setting.
    Eigen::Vector3d origin(Origin origin) const;
    /// The same frame with coordinates relative to the origin of that setting, as a session computes it.
    std::shared_ptr<const Frame> frame(std::size_t index, Origin origin) const;
    /// The same with its successor if `motion` is linear, which needs has_successor for the last frame. Both
    /// then skip the tetrahedra that one of them skips.
    FrameState state(std::size_t index, Motion motion, Origin origin = Origin::world) const;
    bool has_successor() const { return made_ > size(); }

private:
    using Frames = std::vector<std::shared_ptr<Frame>>;
    std::shared_ptr<Frame> make_frame(std::size_t index) const;
    Frames search_flaws(FlawSearch& search, std::size_t most) const;

    const Scene& scene_;
    std::size_t first_, last_;
    std::size_t made_; ///< size(), or one more with a successor
    Flaws flaws_;
    std::optional<FlawSearch> left_out_;            ///< set when frames have tetrahedra to leave out
    Frames stored_;                                 ///< all frames or none
    mutable std::mutex mutex_;                      ///< guards the next three
    mutable std::optional<Eigen::Vector3d> origin_; ///< of Origin::automatic
    mutable std::size_t recent_index_ = 0;
    mutable std::shared_ptr<const Frame> recent_;
};

} // namespace tandem
