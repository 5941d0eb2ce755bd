// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace tandem {

/// What `tandem paper` measures, one after the other: a command of this program, or a plan of cells for
/// `tandem run`.
struct PaperStep {
    std::string name;
    std::string says;                 ///< what for, in a few words
    double seconds = 0;               ///< it took on the machine of the committed results
    std::vector<std::string> command; ///< words after "tandem"; files are in the folder of results
    nlohmann::ordered_json plan;      ///< null, or written to plans/NAME.json before the command runs it
};

/// Names for {device} and {quarter}: a quarter of the device's memory in bytes, at most what one buffer
/// holds, which is the array that the paper's release allocates for queues.
struct PaperPlace {
    std::string device;
    std::uint64_t quarter = 0;
};

/// The steps of a size, "small" or "full", in their order. Throws InputError for another.
std::vector<PaperStep> paper_steps(std::string_view size, const PaperPlace& place);

/// The text of harness/paper/SIZE.json; empty for another size. Made by CMakeLists.txt.
std::string_view paper_plan(std::string_view size);

} // namespace tandem
