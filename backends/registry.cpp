// SPDX-License-Identifier: MIT
#include "backends/registry.h"

#include "backends/cuda/cuda_device.h"
#include "backends/host/host_device.h"
#include "backends/opencl/opencl_device.h"

#include <algorithm>
#include <string_view>

namespace tandem {

namespace {

struct Backend {
    std::string_view name;
    BackendReport (*discover)();
};

constexpr Backend known_backends[] = {
    {"host", host::discover}, {"opencl", opencl::discover}, {"cuda", cuda::discover}};

BackendReport guarded(const Backend& backend) {
    BackendReport report;
    try {
        report = backend.discover();
    } catch (const std::exception& error) {
        report.reason = error.what();
    }
    report.name = backend.name;
    return report;
}

/// Whether a part of "D+E+..." names the backend, one of its devices, or all devices.
bool names(std::string_view wanted, std::string_view backend) {
    for (std::size_t begin = 0; begin <= wanted.size();) {
        const auto end = std::min(wanted.find('+', begin), wanted.size());
        const auto part = wanted.substr(begin, end - begin);
        if (part == "all" || part == "each" || part.substr(0, part.find(':')) == backend) return true;
        begin = end + 1;
    }
    return false;
}

} // namespace

std::vector<BackendReport> discover() {
    const std::string all = "all";
    return discover({&all, 1});
}

std::vector<BackendReport> discover(std::span<const std::string> wanted) {
    std::vector<BackendReport> reports;
    for (const auto& backend : known_backends)
        if (std::ranges::any_of(wanted, [&](const auto& name) { return names(name, backend.name); }))
            reports.push_back(guarded(backend));
    return reports;
}

std::vector<BackendReport> add_missing_backends(std::vector<BackendReport> found) {
    std::vector<BackendReport> all;
    for (const auto& backend : known_backends) {
        const auto own = std::ranges::find(found, backend.name, &BackendReport::name);
        all.push_back(own != found.end() ? std::move(*own) : guarded(backend));
    }
    return all;
}

} // namespace tandem
