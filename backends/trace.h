// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tandem {

struct KernelFacts; // device.h

/// The stages of a frame, to which times are assigned.
enum class Stage {
    transform,
    refit,
    broad,
    seed,
    traverse,
    balance,
    contact,
    sort, ///< canonical order of the answer
    reduce,
    solve,
    preprocess,
    postprocess,
    read,
    write,
    exchange ///< messages between ranks of a job
};
inline constexpr std::array<std::string_view, 15> stage_names{
    "transform", "refit", "broad",      "seed",        "traverse", "balance", "contact", "sort",
    "reduce",    "solve", "preprocess", "postprocess", "read",     "write",   "exchange"};

enum class Command { launch, upload, download, clear, wait, host_work, phase };

/// One executed command, or one span of host work or of a phase. Times in nanoseconds.
struct Event {
    Command command = Command::launch;   ///< kind of the event
    Stage stage = Stage::write;          ///< its times belong to it; waits: that of the last command
    std::string label = {};              ///< kernel entry, buffer label, name of the host work or phase
    std::uint64_t bytes = 0;             ///< moved by transfers and clears
    std::uint64_t groups = 0;            ///< launches: work-groups
    std::uint32_t group_size = 0;        ///< launches: work-items of a group
    std::int64_t host_begin_ns = -1;     ///< the host's steady clock at the start of the call
    std::int64_t host_ns = 0;            ///< host time inside the call
    std::int64_t device_ns = -1;         ///< from the API's events; -1 when not measured
    std::int64_t begin_ns = -1;          ///< device clock at the start; -1 when not measured
    std::uint64_t ticket = 0;            ///< the adaptor's handle for its timing event; 0 = none
    bool blocked = false;                ///< the host waited for the device in this call
    const KernelFacts* kernel = nullptr; ///< launches: the kernel; valid as long as the device
};

/// The events since the last finish(), in order of submission.
struct Trace {
    std::vector<Event> events; ///< empty when clocks are off
};

} // namespace tandem
