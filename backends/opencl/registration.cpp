// SPDX-License-Identifier: MIT
#include "backends/opencl/registration.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace tandem::opencl {

namespace {

namespace fs = std::filesystem;

std::string icd_variable(const char* name) {
    const auto* text = std::getenv(name);
    return text == nullptr ? "" : text;
}

bool is_icd_file(const fs::path& path) { return path.extension() == ".icd"; }

DriverReport read_file(const fs::path& path) {
    DriverReport driver{.file = path.string(), .library = {}, .platforms = {}, .problem = {}};
    errno = 0;
    std::ifstream in(path);
    const bool opened = in.is_open();
    std::getline(in, driver.library);
    if (!opened || (in.bad() && driver.library.empty()))
        driver.problem = fmt::format("the file cannot be read ({})", std::strerror(errno));
    if (driver.problem.empty() && driver.library.empty())
        driver.problem = "the first line of the file names no library";
    return driver;
}

std::vector<DriverReport> read_folder(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code ignored; // without a folder, no driver is registered
    for (fs::directory_iterator entry(folder, ignored); entry != fs::directory_iterator();
         entry.increment(ignored))
        if (is_icd_file(entry->path())) files.push_back(entry->path());
    std::sort(files.begin(), files.end());
    std::vector<DriverReport> drivers;
    for (const auto& file : files) drivers.push_back(read_file(file));
    return drivers;
}

DriverReport library_alone(std::string library) {
    return {.file = {}, .library = std::move(library), .platforms = {}, .problem = {}};
}

std::vector<DriverReport> read_vendors() {
    const auto given = icd_variable("OCL_ICD_VENDORS");
    auto folder = icd_variable("OPENCL_VENDOR_PATH");
    if (folder.empty()) folder = "/etc/OpenCL/vendors";
    if (given.empty()) return read_folder(folder);
    std::error_code ignored;
    if (given.back() == '/' || fs::is_directory(given, ignored)) return read_folder(given);
    if (!is_icd_file(given)) return {library_alone(given)};
    return {read_file(given.find('/') == std::string::npos ? fs::path(folder) / given : fs::path(given))};
}

} // namespace

std::vector<DriverReport> read_registration() {
    auto drivers = read_vendors();
    const auto names = icd_variable("OCL_ICD_FILENAMES");
    for (std::size_t begin = 0; begin < names.size();) {
        const auto end = std::min(names.find(':', begin), names.size());
        if (end > begin) drivers.push_back(library_alone(names.substr(begin, end - begin)));
        begin = end + 1;
    }
    return drivers;
}

} // namespace tandem::opencl
