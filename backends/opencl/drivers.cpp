// SPDX-License-Identifier: MIT
#include "backends/opencl/drivers.h"

#include "backends/opencl/description.h"
#include "backends/opencl/registration.h"
#include "base/private_folder.h"
#include "base/text_lines.h"

#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>
#include <fmt/format.h>

namespace tandem::opencl {

namespace {

namespace fs = std::filesystem;

using GetFunction = void*(const char*);
using GetPlatforms = cl_int(cl_uint, cl_platform_id*, cl_uint*);

std::string loader_error() {
    const auto* text = dlerror();
    return text == nullptr ? "the system gives no reason" : visible(text);
}

/// The most frequent reason that needs an action: this program has loaded an older oneTBB of the same name.
std::string advice(const std::string& reason, const std::string& library) {
    if (reason.find("undefined symbol: _ZN3tbb") == std::string::npos) return {};
    const auto* own = "libtbb.so.12";
    const auto beside = fs::path(library).parent_path() / own;
    std::error_code ignored;
    return fmt::format("; it needs a newer oneTBB than the one of this program: set LD_PRELOAD={}",
                       fs::exists(beside, ignored) ? beside.string() : fmt::format("FOLDER/{}", own));
}

/// PoCL's rule for the folder of its compiled kernels.
fs::path pocl_cache() {
    if (const auto* folder = std::getenv("POCL_CACHE_DIR")) return folder;
    if (const auto* folder = std::getenv("XDG_CACHE_HOME"); folder != nullptr && *folder != '\0')
        return fs::path(folder) / "pocl/kcache";
    if (const auto* home = std::getenv("HOME")) return fs::path(home) / ".cache/pocl/kcache";
    return "/tmp/pocl/kcache";
}

/// Why the kernel cache of a platform cannot be written; empty when it can, or is unknown.
std::string cache_problem(const std::string& platform) {
    if (platform != "Portable Computing Language") return {};
    const auto folder = pocl_cache();
    const auto why = why_not_writable(folder);
    if (why.empty()) return {};
    return fmt::format("its kernel cache {} cannot be written ({}); set POCL_CACHE_DIR to a folder that can",
                       visible(folder.string()), why);
}

DriverReport::Platform platform_of(cl_platform_id platform) {
    std::size_t size = 0;
    clGetPlatformInfo(platform, CL_PLATFORM_NAME, 0, nullptr, &size);
    DriverReport::Platform found{.name = std::string(size, '\0'), .devices = 0};
    clGetPlatformInfo(platform, CL_PLATFORM_NAME, size, found.name.data(), nullptr);
    while (!found.name.empty() && found.name.back() == '\0') found.name.pop_back();
    found.name = visible(found.name);
    cl_uint count = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) == CL_SUCCESS) found.devices = count;
    return found;
}

/// The platforms of an opened driver, or the reason why it lists none.
std::vector<cl_platform_id> platforms_of(DriverReport& driver, void* library) {
    auto* const get = reinterpret_cast<GetFunction*>(dlsym(library, "clGetExtensionFunctionAddress"));
    auto* list = get == nullptr ? nullptr : reinterpret_cast<GetPlatforms*>(get("clIcdGetPlatformIDsKHR"));
    if (list == nullptr) {
        driver.problem =
            fmt::format("the library is no OpenCL driver: it has no {}",
                        get == nullptr ? "clGetExtensionFunctionAddress" : "clIcdGetPlatformIDsKHR");
        return {};
    }
    cl_uint count = 0;
    if (const auto code = list(0, nullptr, &count); code != CL_SUCCESS || count == 0) {
        driver.problem = fmt::format("it lists no platform (code {})", code);
        return {};
    }
    std::vector<cl_platform_id> platforms(count);
    list(count, platforms.data(), nullptr);
    return platforms;
}

/// Fills in the platforms of a driver that the loader uses.
void ask(DriverReport& driver, void* library) {
    for (auto* platform : platforms_of(driver, library)) {
        auto found = platform_of(platform);
        if (found.devices == 0) {
            const auto cache = cache_problem(found.name);
            driver.problem =
                fmt::format("platform '{}' has no device{}{}", found.name, cache.empty() ? "" : ": ", cache);
        }
        driver.platforms.push_back(std::move(found));
    }
}

void examine(DriverReport& driver) {
    if (!driver.problem.empty()) return;
    void* loaded = dlopen(driver.library.c_str(), RTLD_LAZY | RTLD_NOLOAD);
    if (loaded != nullptr) {
        ask(driver, loaded);
        dlclose(loaded); // the loader keeps it open
        return;
    }
    loaded = dlopen(driver.library.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (loaded == nullptr) {
        const auto reason = loader_error();
        driver.problem =
            fmt::format("the library does not load: {}{}", reason, advice(reason, driver.library));
        return;
    }
    // Drivers do not support being unloaded, so that it stays. The loader has not prepared its platforms for
    // calls.
    platforms_of(driver, loaded);
    if (driver.problem.empty()) driver.problem = "the library works, but the OpenCL loader has not loaded it";
}

} // namespace

std::string cache_problem(cl_device_id device) {
    return cache_problem(platform_of(device_value<cl_platform_id>(device, CL_DEVICE_PLATFORM)).name);
}

std::vector<DriverReport> registered_drivers() {
    auto drivers = read_registration();
    for (auto& driver : drivers) {
        examine(driver);
        driver.file = visible(driver.file);
        driver.library = visible(driver.library);
    }
    return drivers;
}

std::string sentence(const DriverReport& driver) {
    const auto& name = driver.file.empty() ? driver.library : driver.file;
    const bool both = !driver.file.empty() && !driver.library.empty();
    return fmt::format("{}{}: {}", name, both ? fmt::format(" ({})", driver.library) : "", driver.problem);
}

} // namespace tandem::opencl
