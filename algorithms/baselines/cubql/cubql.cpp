// SPDX-License-Identifier: MIT
#include "algorithms/traversal.h"

#include "algorithms/baselines/cubql/cubql_stages.h"
#include "algorithms/bodies/cost.h"
#include "algorithms/pipeline/pipeline.h"
#include "base/error.h"

#include <fmt/format.h>

namespace tandem {

namespace {

const std::vector<Preset> all_presets{
    {"resident",
     "boxes, one tree per body built once by the surface area heuristic and refitted in every frame, queries "
     "of "
     "all body pairs in one launch",
     {parameters::k(6), parameters::broad(Broad::device), parameters::builder(Builder::sah)},
     "cuBQL"}};

constexpr std::array all_counters{cubql_counters::leaf_tests};

class Cubql : public Traversal {
public:
    std::string_view name() const override { return "cubql"; }
    std::string_view summary() const override {
        static const auto text = [] {
            std::string summary =
                "NVIDIA's cuBQL, box queries into one tree per body: CUDA devices, k=6, float";
            if (!cubql_absence().empty()) summary += fmt::format(" ({})", cubql_absence());
            return summary;
        }();
        return text;
    }
    std::span<const Parameter* const> parameters() const override {
        static const auto all = pipeline_parameters({}, false);
        return all;
    }
    std::span<const Preset> presets() const override { return all_presets; }
    std::span<const Counter> counters() const override { return all_counters; }

private:
    void do_check(const Settings& settings, const DeviceInfo& info) const override {
        namespace p = tandem::parameters;
        if (!cubql_absence().empty()) throw InputError(fmt::format("algorithm cubql: {}", cubql_absence()));
        // The builder opens the device by its number.
        if (!info.id.starts_with("cuda:") || info.id.find_first_not_of("0123456789", 5) != std::string::npos)
            throw InputError(fmt::format(
                "algorithm cubql works on CUDA devices only, not on {}; give --device cuda:0", info.id));
        const auto refuse = [&](std::string_view setting, std::string_view why, std::string_view choice) {
            throw InputError(fmt::format("setting {}={} is impossible with algorithm cubql, {}; choose {}",
                                         setting, settings.text(setting), why, choice));
        };
        if (settings[p::k] != 6) refuse("k", "whose bounds are boxes along x, y and z", "6");
        if (settings[p::precision] != Precision::fp32) refuse("precision", "whose boxes are floats", "float");
        if (settings[p::rounding] == Rounding::published)
            refuse("rounding", "whose overlap test has no tolerance", "safe");
        if (!has_pairs(settings[p::output])) refuse("output", "which writes pairs", "pairs");
        if (settings[p::self] != SelfPairs::off)
            refuse("self", "whose queries are of one body's boxes into another body's tree", "off");
        if (settings[p::pair_layout] != PairLayout::slots)
            refuse("pair_layout", "which writes slots", "slots");
    }

    std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const override {
        auto costs = tile_tree_costs({scene, settings}, 6, false);
        for (const auto* entry : {"copy_boxes_cubql", "refit_cubql", "collide_cubql"})
            costs.push_back({entry, {}, {}, "nothing: the work of another library is not counted"});
        return costs;
    }

    AlgorithmStages do_build(const BuildContext& context) const override { return cubql_stages(context); }
};

} // namespace

/// NVIDIA's cuBQL, box queries into one tree per body: the library form that is fastest for this question. A
/// baseline for one precision and one k, on CUDA.
const Traversal& cubql() {
    static const Cubql instance;
    return instance;
}

} // namespace tandem
