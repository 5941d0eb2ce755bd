// SPDX-License-Identifier: MIT
#pragma once

#include "harness/verify/oracle/frame_truth.h"

#include <memory>
#include <optional>

namespace tandem {

/// An answer judged by the input: the scene's vertices in double, moved by the poses without rounding. A cell
/// rounds them first; pairs and depths that differ between its vertices and the input are changed by rounding
/// alone, whatever the answer.
struct RoundingErrors {
    std::uint64_t meeting = 0; ///< pairs that meet by the input
    std::uint64_t lost = 0;    ///< of these, the pairs that do not meet by the cell's vertices
    std::uint64_t extra = 0;   ///< pairs that meet by the cell's vertices only
    std::uint64_t missed = 0;  ///< pairs that meet by the input and are no candidates of the answer
    /// Largest change of a depth, over pairs that overlap by either, a depth of 0 where a pair does not;
    /// empty if contacts are not requested.
    std::optional<double> depth_change;

    void add(const RoundingErrors& other);
    bool operator==(const RoundingErrors&) const = default;
};

/// A frame with its rounding: `cell` is relative to `origin`, `input` to the world's origin.
struct RoundedFrame {
    const Scene& scene;
    std::shared_ptr<const Frame> input, cell;
    Eigen::Vector3d origin;
    Positions positions; ///< those of the cell
};

/// Whether a vertex of the cell is not exactly the input's. Stops at the first one, which is among the first
/// wherever a body is turned.
bool rounds(const RoundedFrame& frame);

/// Compares the two truths of a frame; `missed` and `depth_change` stay empty.
RoundingErrors rounding_errors(const FrameTruth& cell, const FrameTruth& input);

/// The largest change of a depth, over at most `most` pairs that overlap by either truth, evenly spread over
/// their order; 0: all. Takes about 0.5 ms a pair.
double depth_change(const RoundedFrame& frame, const FrameTruth& cell, const FrameTruth& input,
                    std::size_t most);

} // namespace tandem
