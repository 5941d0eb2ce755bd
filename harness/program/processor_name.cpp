// SPDX-License-Identifier: MIT
#include "harness/program/processor_name.h"

#include <fstream>

namespace tandem {

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return {};
}

} // namespace tandem
