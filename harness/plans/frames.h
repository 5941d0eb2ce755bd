// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "harness/verify/flaw_search.h"

#include <memory>
#include <mutex>
#include <optional>

namespace tandem {

/// Bytes of frames that a range holds. Ranges of scripted scenes and of recordings of a few million vertices
/// fit, and are replayed from memory; what does not fit is a long recording of deformable bodies, and beside
/// this much a machine with 4 GiB still has room for the scene, its reference and its truth.
inline constexpr std::uint64_t frame_budget = std::uint64_t{1} << 30;

/// Throws InputError when the scene has no such frames, which says why.
void check_frames(const Scene& scene, std::size_t first, std::size_t last);

/// Frames FIRST..LAST of a scene with their flaws handled. All are held when they fit the budget; otherwise
/// the one that was asked for last is, and every other one is made when it is asked for, by Scene::frame and
/// then by FlawSearch::leave_out, which takes as long as reading and checking it. Any number of threads may
/// ask.
class FrameRange {
public:
    /// Makes every frame once and handles flaws, with no more than `budget` bytes of frames at a time, or one
    /// frame. Throws InputError: there are no such frames, one cannot be read, or what `handling` refuses.
    /// The scene must outlive this, in its place.
    FrameRange(const Scene& scene, std::size_t first, std::size_t last,
               Degenerate handling = Degenerate::flat, std::uint64_t budget = frame_budget);
    FrameRange(const FrameRange&) = delete;
    FrameRange& operator=(const FrameRange&) = delete;

    std::size_t first() const { return first_; }
    std::size_t last() const { return last_; }
    std::size_t size() const { return last_ - first_ + 1; }
    /// Of all frames, and how they were handled.
    const Flaws& flaws() const { return flaws_; }
    /// Frame first() + index, which stays as it is for as long as the caller keeps it. Not to be called in a
    /// span that is timed. Throws InputError when a recording cannot be read any more.
    std::shared_ptr<const Frame> frame(std::size_t index) const;
    /// The same as a session of that setting has it: coordinates count from its origin.
    std::shared_ptr<const Frame> frame(std::size_t index, Origin origin) const;

private:
    using Frames = std::vector<std::shared_ptr<Frame>>;
    std::shared_ptr<Frame> made(std::size_t index) const;
    Frames look_through(FlawSearch& search, std::size_t most) const;

    const Scene& scene_;
    std::size_t first_, last_;
    Flaws flaws_;
    std::optional<FlawSearch> left_out_; ///< where frames have something to leave out
    Frames held_;                        ///< all or none
    mutable std::mutex mutex_;           ///< of the next two
    mutable std::size_t recent_index_ = 0;
    mutable std::shared_ptr<const Frame> recent_;
};

} // namespace tandem
