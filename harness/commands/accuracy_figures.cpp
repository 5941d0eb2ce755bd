// SPDX-License-Identifier: MIT
#include "harness/commands/accuracy_figures.h"

#include "harness/program/external.h"
#include "harness/program/programs.h"
#include "base/error.h"
#include "base/files_in_use.h"

#include <filesystem>
#include <fmt/format.h>

namespace tandem {

namespace {

constexpr auto figures_program = "figures"; // in libexec/tandem

} // namespace

Figures::Figures(std::string folder) : folder_(std::move(folder)) {
    external_program(figures_program);
    python_with("matplotlib", "python3-matplotlib", "--figures");
    std::error_code code;
    std::filesystem::create_directories(folder_, code);
    if (code) throw InputError(fmt::format("--figures: cannot make {}: {}", folder_, code.message()));
    for (const auto& file : std::filesystem::directory_iterator(folder_))
        if (file.path().extension() == ".svg" || file.path().extension() == ".csv") check_output(file.path());
}

void Figures::draw(const std::string& records) const {
    if (run_external(figures_program, {"--", records, folder_}) != 0)
        throw InputError(fmt::format("--figures: nothing drawn; the records are in {}", records));
}

} // namespace tandem
