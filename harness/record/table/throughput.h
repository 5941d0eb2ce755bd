// SPDX-License-Identifier: MIT
#pragma once

#include "harness/record/verdict.h"

#include <array>
#include <optional>
#include <string_view>

namespace tandem {

/// Names of the columns that --columns adds, which are also their units.
inline constexpr std::array<std::string_view, 2> throughput_names{"pairs/s", "GB/s"};

/// Candidate pairs a second of the median frame. None without samples.
std::optional<double> pairs_per_s(const Measurement& m);

/// Bytes a second of the median frame that its kernels need at least: the cost models of `tandem profile`
/// (algorithms/bodies/cost.h), each input read once and each output written once. The data that pairs touch
/// are not downloaded, so the number is a lower bound. None without samples or models.
std::optional<double> bytes_per_s(const Row& row, const Scene& scene);

} // namespace tandem
