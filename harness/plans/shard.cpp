// SPDX-License-Identifier: MIT
#include "harness/plans/shard.h"

#include "base/error.h"

#include <charconv>
#include <cstdlib>
#include <fmt/format.h>
#include <optional>
#include <string_view>

namespace tandem {

namespace {

/// The number that is the whole text; none when it is no number.
std::optional<std::size_t> number_of(std::string_view text) {
    std::size_t value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || result.ec != std::errc{} || result.ptr != text.data() + text.size())
        return std::nullopt;
    return value;
}

std::optional<std::size_t> number_in_environment(const char* name) {
    const char* text = std::getenv(name);
    return text != nullptr ? number_of(text) : std::nullopt;
}

/// Task numbers of an array may start at any number and have any constant step.
Shard shard_of_slurm() {
    const auto task = number_in_environment("SLURM_ARRAY_TASK_ID");
    const auto first = number_in_environment("SLURM_ARRAY_TASK_MIN");
    const auto count = number_in_environment("SLURM_ARRAY_TASK_COUNT");
    const auto step = number_in_environment("SLURM_ARRAY_TASK_STEP").value_or(1);
    if (!task || !first || !count || step == 0 || *task < *first || (*task - *first) % step != 0
        || (*task - *first) / step >= *count)
        throw InputError(
            "--shard slurm: this process is not a task of a job array with evenly spaced numbers; submit it "
            "with sbatch --array=0-N, or give I/N");
    return {(*task - *first) / step, *count};
}

} // namespace

Shard parse_shard(const std::string& text) {
    if (text == "slurm") return shard_of_slurm();
    const auto slash = text.find('/');
    const auto index = number_of(std::string_view(text).substr(0, slash));
    const auto of =
        slash == std::string::npos ? std::nullopt : number_of(std::string_view(text).substr(slash + 1));
    if (!index || !of || *index >= *of)
        throw InputError(fmt::format("--shard {}: give I/N with I from 0 to N - 1, or slurm", text));
    return {*index, *of};
}

} // namespace tandem
