// SPDX-License-Identifier: MIT
#include "harness/accuracy/figures.h"

#include "harness/external.h"
#include "harness/programs.h"
#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <filesystem>
#include <fmt/format.h>

namespace tandem {

Figures::Figures(std::string folder)
    : folder_(std::move(folder)),
      script_(external_program("figures")),
      python_(python_with("matplotlib", "python3-matplotlib", "--figures")) {
    std::error_code code;
    std::filesystem::create_directories(folder_, code);
    if (code) throw InputError(fmt::format("--figures: cannot make {}: {}", folder_, code.message()));
}

void Figures::draw(const std::string& records) const {
    // What has been printed comes before what the script prints. It draws as well where that cannot be read.
    const ProgramPlace place{"", flush_output() ? "" : "/dev/null", ""};
    if (run_program({python_, script_, records, folder_}, place) != 0)
        throw InputError(fmt::format("--figures: nothing drawn; the records are in {}", records));
}

} // namespace tandem
