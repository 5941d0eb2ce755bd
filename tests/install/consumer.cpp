// SPDX-License-Identifier: MIT
// Finds candidate pairs on the host with the installed library and prints their number.
#include "find_pairs.h"

#include <tandem/backends/host/host_device.h>

#include <cstdio>

int main() {
    const auto device = tandem::host::make_device();
    const auto count = candidate_pairs(*device);
    std::printf("%llu candidate pairs\n", static_cast<unsigned long long>(count));
    return count > 0 ? 0 : 1;
}
