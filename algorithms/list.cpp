// SPDX-License-Identifier: MIT
#include "algorithms/chunked/chunked.h"
#include "algorithms/gproximity/gproximity.h"
#include "algorithms/sources.h"
#include "scenes/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

std::span<const Traversal* const> algorithms() {
    static const std::array all{&chunked(), &gproximity()};
    return all;
}

const Traversal& algorithm(std::string_view name) {
    std::vector<std::string> names;
    for (const auto* candidate : algorithms()) {
        if (candidate->name() == name) return *candidate;
        names.emplace_back(candidate->name());
    }
    throw InputError(unknown("algorithm", name, names));
}

const Preset& preset(const Traversal& traversal, std::string_view name) {
    std::vector<std::string> names;
    for (const auto& candidate : traversal.presets()) {
        if (candidate.name == name) return candidate;
        names.push_back(candidate.name);
    }
    throw InputError(unknown(fmt::format("preset of {}", traversal.name()), name, names));
}

std::unique_ptr<Session> Traversal::prepare(std::span<Device* const> devices, const Scene& scene,
                                            const Settings& settings) const {
    if (devices.size() != 1)
        throw InputError(
            fmt::format("{} runs on one device at a time; {} were given", name(), devices.size()));
    if (scene.bodies.empty()) throw InputError(fmt::format("scene {} has no bodies", scene.name));
    check(settings, devices.front()->info());
    return do_prepare(*devices.front(), scene, settings);
}

const KernelSource& kernel_source(std::string_view name) {
    for (const auto& source : kernel_sources())
        if (source.name == name) return source;
    throw DeviceError(fmt::format("no kernel file '{}' in this program", name));
}

} // namespace tandem
