// SPDX-License-Identifier: MIT
#include "python/core/process.h"

#include "backends/device.h"
#include "base/error.h"

#include <algorithm>
#include <atomic>
#include <fmt/format.h>
#include <unistd.h>

namespace tandem::python {

namespace {

std::atomic<pid_t> opener = 0; ///< the first process that opened a runtime; 0: none

} // namespace

void note_runtime() {
    pid_t none = 0;
    opener.compare_exchange_strong(none, getpid());
}

bool is_forked() { return opener != 0 && opener != getpid(); }

bool has_runtime(const DeviceGroup& devices) {
    return std::ranges::any_of(devices, [](const Device* device) { return device->info().id != "host"; });
}

void check_process(std::string_view use) {
    if (is_forked())
        throw DeviceError(
            fmt::format("{}: this process was forked after its parent had opened OpenCL or CUDA, "
                        "which do not survive that; open devices after the fork only, or start "
                        "processes with multiprocessing's method spawn",
                        use));
}

} // namespace tandem::python
