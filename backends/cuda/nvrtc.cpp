// SPDX-License-Identifier: MIT
#include "backends/cuda/nvrtc.h"

#include "backends/cuda/driver.h"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem::cuda {

namespace {

/// The libraries to try. A compiler of a newer major version than the driver produces code that does not
/// load.
std::vector<std::string> candidates(int driver_version) {
    if (const auto* chosen = std::getenv("TANDEM_NVRTC")) return {chosen};
    static const std::vector<std::pair<int, std::string>> known{
        {13, "libnvrtc.so.13"}, {12, "libnvrtc.so.12"}, {11, "libnvrtc.so.11.2"}, {11, "libnvrtc.so.11.1"}};
    std::vector<std::string> names;
    const int major = driver_version == 0 ? known.front().first : driver_version / 1000;
    for (const auto& [version, name] : known) {
        if (version > major) continue;
        names.push_back(name);
        // The loader may not search a toolkit's own folder.
        names.push_back("/usr/local/cuda/lib64/" + name);
    }
    return names;
}

Library open_nvrtc(int driver_version) {
    const auto names = candidates(driver_version);
    if (names.empty())
        throw DeviceError(
            fmt::format("no known NVRTC works with a driver for CUDA {}", version_text(driver_version)));
    try {
        return Library(names);
    } catch (const DeviceError& error) {
        throw DeviceError(fmt::format("no NVRTC ({}); install it or name it in TANDEM_NVRTC", error.what()));
    }
}

std::filesystem::path cache_folder() {
    const auto* folder = std::getenv("TANDEM_KERNEL_CACHE");
    return folder == nullptr ? "" : folder;
}

/// Reads all bytes of one output of a program; returns the code of the first call that failed.
template<class Bytes, class Size, class Get>
NvrtcResult take(Bytes& bytes, Program program, Size size_of, Get get) {
    std::size_t size = 0;
    const auto code = size_of(program, &size);
    bytes.resize(code == 0 ? size : 0);
    return code == 0 ? get(program, bytes.data()) : code;
}

} // namespace

Nvrtc::Nvrtc(int driver_version, std::optional<std::filesystem::path> cache)
    : library_(open_nvrtc(driver_version)), cache_(cache ? *cache : cache_folder()) {
    const auto load = [&](auto*& entry, const char* name) {
        entry = reinterpret_cast<std::remove_reference_t<decltype(entry)>>(library_.find(name));
        if (entry == nullptr)
            throw DeviceError(
                fmt::format("{} has no {}; install NVRTC 11.2 or newer", library_.name(), name));
    };
#define TANDEM_LOAD(name, arguments) load(name, #name);
    TANDEM_NVRTC_ENTRIES(TANDEM_LOAD)
#undef TANDEM_LOAD
    int major = 0;
    int minor = 0;
    if (const auto code = nvrtcVersion(&major, &minor); code != 0)
        throw DeviceError(fmt::format("{} does not report its version (code {})", library_.name(), code));
    version_ = major * 1000 + minor * 10;
    if (driver_version != 0 && major > driver_version / 1000)
        throw DeviceError(
            fmt::format("NVRTC {} is newer than the driver, which is for CUDA {}; install a newer driver or "
                        "name an older NVRTC in TANDEM_NVRTC",
                        version_text(version_), version_text(driver_version)));
    int count = 0;
    auto code = nvrtcGetNumSupportedArchs(&count);
    architectures_.resize(static_cast<std::size_t>(std::max(count, 0)));
    if (code == 0) code = nvrtcGetSupportedArchs(architectures_.data());
    if (code != 0)
        throw DeviceError(
            fmt::format("{} does not report its target architectures (code {})", library_.name(), code));
    std::sort(architectures_.begin(), architectures_.end());
}

Image Nvrtc::compile(const KernelSource& source, const Defines& defines, int architecture, bool ptx) const {
    const auto above = std::upper_bound(architectures_.begin(), architectures_.end(), architecture);
    if (above == architectures_.begin())
        throw DeviceError(fmt::format("NVRTC {} does not support compute capability {}.{}; use an older one",
                                      version_text(version_), architecture / 10, architecture % 10));
    const int target = *(above - 1);
    const bool machine_code = target == architecture && !ptx;
    std::vector<std::string> options{
        fmt::format("-arch={}_{}", machine_code ? "sm" : "compute", target),
        "--std=c++17",
        "-fmad=false",
        "-prec-div=true",
        "-prec-sqrt=true",
        "-ftz=false",
        "-lineinfo",           // for profilers: adds files and lines, leaves the code unchanged
        "-diag-suppress=177"}; // a kernel file has more functions than each entry needs
    if (machine_code) options.emplace_back("--ptxas-options=-v");
    for (const auto& [name, value] : defines) options.push_back(fmt::format("-D{}={}", name, value));
    const auto key = fmt::format("NVRTC {} {}\n{}\n{}\n{}", version_, library_.name(),
                                 fmt::join(options, " "), source.name, source.text);
    if (auto known = cache_.find(key)) return *known;
    auto image = compile_uncached(
        source, options, machine_code,
        fmt::format("{}_{} {}", machine_code ? "sm" : "compute", target, machine_code ? "cubin" : "ptx"));
    cache_.keep(key, image);
    return image;
}

Image Nvrtc::compile_uncached(const KernelSource& source, const std::vector<std::string>& options,
                              bool machine_code, std::string target) const {
    std::vector<const char*> texts;
    std::transform(options.begin(), options.end(), std::back_inserter(texts),
                   [](auto& o) { return o.c_str(); });

    Program program = nullptr;
    const std::string text(source.text);
    const std::string name(source.name);
    Image image;
    image.target = std::move(target);
    auto code = nvrtcCreateProgram(&program, text.c_str(), name.c_str(), 0, nullptr, nullptr);
    if (code == 0) {
        code = nvrtcCompileProgram(program, static_cast<int>(texts.size()), texts.data());
        const auto log = take(image.log, program, nvrtcGetProgramLogSize, nvrtcGetProgramLog);
        if (code == 0) code = log; // the log reports spills
        if (code == 0)
            code = machine_code ? take(image.bytes, program, nvrtcGetCUBINSize, nvrtcGetCUBIN)
                                : take(image.bytes, program, nvrtcGetPTXSize, nvrtcGetPTX);
        nvrtcDestroyProgram(&program);
    }
    if (code == 0 && !image.bytes.empty()) return image;
    image.log = image.log.substr(0, image.log.find('\0')); // the log's size includes its zero byte
    std::replace(image.log.begin(), image.log.end(), '\n', ' ');
    throw DeviceError(fmt::format("{} does not compile with NVRTC {} for {} and {}: {}", source.name,
                                  version_text(version_), image.target, fmt::join(options, " "),
                                  image.log.empty() ? fmt::format("code {}", code) : image.log));
}

} // namespace tandem::cuda
