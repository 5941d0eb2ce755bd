// SPDX-License-Identifier: MIT
#include "algorithms/kernels/sources.h"
#include "algorithms/traversal.h"
#include "base/digest.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <vector>

// The algorithms, one line each, in the order of listings. NAME.cpp defines `const Traversal& NAME()`, the
// instance. Baselines are libraries of others.
// clang-format off
#define TANDEM_ALGORITHMS(ALGORITHM) \
    ALGORITHM(tiled) \
    ALGORITHM(chunked) \
    ALGORITHM(gproximity) \
    ALGORITHM(leaf_query)
#define TANDEM_BASELINES(ALGORITHM) \
    ALGORITHM(embree) \
    ALGORITHM(cubql)
// clang-format on

namespace tandem {

#define TANDEM_DECLARE(name) const Traversal& name();
#define TANDEM_ADDRESS(name) &name(),

TANDEM_ALGORITHMS(TANDEM_DECLARE)
TANDEM_BASELINES(TANDEM_DECLARE)

namespace {

std::vector<const Traversal*>& known_algorithms() {
    static std::vector<const Traversal*> all{TANDEM_ALGORITHMS(TANDEM_ADDRESS)};
    return all;
}

std::vector<std::span<const KernelSource>>& known_sources() {
    static std::vector<std::span<const KernelSource>> all{kernel_sources()};
    return all;
}

} // namespace

std::span<const Traversal* const> algorithms() { return known_algorithms(); }

std::span<const Traversal* const> baselines() {
    static const std::vector<const Traversal*> all{TANDEM_BASELINES(TANDEM_ADDRESS)};
    return all;
}

void add_algorithm(const Traversal& traversal) {
    for (const auto& list : {algorithms(), baselines()})
        for (const auto* other : list)
            if (other->name() == traversal.name())
                throw InputError(
                    fmt::format("an algorithm {} exists already; choose another name", traversal.name()));
    known_algorithms().push_back(&traversal);
}

const Traversal& algorithm(std::string_view name) {
    std::vector<std::string> names;
    for (const auto& list : {algorithms(), baselines()})
        for (const auto* candidate : list) {
            if (candidate->name() == name) return *candidate;
            names.emplace_back(candidate->name());
        }
    throw InputError(unknown("algorithm", name, names));
}

const Preset& preset(const Traversal& traversal, std::string_view name) {
    std::vector<std::string> names;
    for (const auto& candidate : traversal.presets()) {
        if (candidate.name == name) return candidate;
        names.emplace_back(candidate.name);
    }
    throw InputError(unknown(fmt::format("preset of {}", traversal.name()), name, names));
}

std::string title_of(const Traversal& traversal, const Preset& preset) {
    return preset.title.empty() ? fmt::format("{} {}", traversal.name(), preset.name)
                                : std::string(preset.title);
}

void add_kernel_sources(std::span<const KernelSource> sources) { known_sources().push_back(sources); }

const KernelSource& kernel_source(std::string_view name) {
    for (const auto& sources : known_sources())
        for (const auto& source : sources)
            if (source.name == name) return source;
    throw DeviceError(fmt::format("no kernel file '{}' in this program", name));
}

std::uint64_t kernel_sources_digest() {
    std::string digests;
    for (const auto& sources : known_sources())
        for (const auto& source : sources) digests += fmt::format("{:016x}", digest_of(source.text));
    return digest_of(digests);
}

} // namespace tandem
