// SPDX-License-Identifier: MIT
#include "backends/registry.h"

#include "backends/cuda/cuda_device.h"
#include "backends/host/host_device.h"
#include "backends/opencl/opencl_device.h"

namespace tandem {

namespace {

BackendReport find_host() {
    BackendReport report{.name = "host", .devices = {}, .reason = {}};
    report.devices.push_back(host::make_device());
    return report;
}

BackendReport find_opencl() {
    auto found = opencl::discover();
    return {.name = "opencl", .devices = std::move(found.devices), .reason = std::move(found.reason)};
}

BackendReport find_cuda() {
    auto found = cuda::discover();
    return {.name = "cuda", .devices = std::move(found.devices), .reason = std::move(found.reason)};
}

template<class Find>
BackendReport guarded(std::string name, Find find) {
    try {
        return find();
    } catch (const std::exception& error) {
        return {.name = std::move(name), .devices = {}, .reason = error.what()};
    }
}

} // namespace

std::vector<BackendReport> discover() {
    std::vector<BackendReport> reports;
    reports.push_back(guarded("host", find_host));
    reports.push_back(guarded("opencl", find_opencl));
    reports.push_back(guarded("cuda", find_cuda));
    return reports;
}

} // namespace tandem
