// SPDX-License-Identifier: MIT
// The device of a command that names none.
#include "harness/plans/device_groups.h"
#include "tests/nvrtc/compiling_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

/// A backend with a device for each letter: 'g' is a GPU, 'p' a processor.
BackendReport backend(const std::string& name, std::string_view kinds) {
    BackendReport report{.name = name};
    for (const char kind : kinds) {
        DeviceInfo info;
        info.id = name == "host" ? name : fmt::format("{}:{}", name, report.devices.size());
        info.is_gpu = kind == 'g';
        report.devices.push_back(std::make_unique<CompilingDevice>(info));
    }
    return report;
}

/// The default device when these are all devices.
std::string chosen(std::string_view host, std::string_view opencl, std::string_view cuda) {
    std::vector<BackendReport> backends;
    backends.push_back(backend("host", host));
    backends.push_back(backend("opencl", opencl));
    backends.push_back(backend("cuda", cuda));
    const auto* device = default_of(backends);
    return device == nullptr ? "" : device->info().id;
}

TEST(DefaultDevice, IsTheFirstGpuElseTheHost) {
    EXPECT_EQ(chosen("p", "gg", "gg"), "cuda:0");
    EXPECT_EQ(chosen("p", "pgg", ""), "opencl:1");
    EXPECT_EQ(chosen("p", "p", ""), "host");
    EXPECT_EQ(chosen("p", "", ""), "host");
    EXPECT_EQ(chosen("", "p", ""), "");
}

TEST(DefaultDevice, IsOneOfTheNamedOnes) {
    std::vector<BackendReport> backends;
    backends.push_back(backend("host", "p"));
    backends.push_back(backend("opencl", "pg"));
    const std::vector<std::string> names{"opencl:1", default_device, "host"};
    const auto groups = choose_devices(backends, names);
    ASSERT_EQ(groups.size(), 2u);
    EXPECT_EQ(name_of(groups[0]), "opencl:1");
    EXPECT_EQ(name_of(groups[1]), "host");
}

} // namespace
} // namespace tandem
