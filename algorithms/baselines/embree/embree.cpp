// SPDX-License-Identifier: MIT
#include "algorithms/traversal.h"

#include "algorithms/bodies/cost.h"
#include "algorithms/baselines/embree/embree_stages.h"
#include "algorithms/pipeline/pipeline.h"
#include "base/error.h"

#include <fmt/format.h>

namespace tandem {

namespace {

const std::vector<Preset> all_presets{
    {"resident",
     "boxes, one tree per body built once and refitted in every frame, body pairs by the device's kernels",
     {parameters::k(6), parameters::broad(Broad::device), parameters::builder(Builder::sah)},
     "Embree"}};

constexpr std::array all_counters{embree_counters::leaf_tests};

class Embree : public Traversal {
public:
    std::string_view name() const override { return "embree"; }
    std::string_view summary() const override {
        static const auto text = [] {
            std::string summary =
                "Intel's Embree, rtcCollide over one tree per body: device host, k=6, float";
            if (!embree_absence().empty()) summary += fmt::format(" ({})", embree_absence());
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
        if (!embree_absence().empty())
            throw InputError(fmt::format("algorithm embree: {}", embree_absence()));
        if (info.id != "host")
            throw InputError(fmt::format(
                "algorithm embree works on device host only, not on {}; give --device host", info.id));
        if (settings[tandem::parameters::k] != 6)
            throw InputError(
                fmt::format("setting k={} is impossible with algorithm embree, whose bounds are boxes along "
                            "x, y and z; choose k=6",
                            settings[tandem::parameters::k]));
        if (settings[tandem::parameters::precision] != Precision::fp32)
            throw InputError("setting precision=double is impossible with algorithm embree, whose boxes are "
                             "floats; choose float");
    }

    std::vector<KernelCost> do_costs(const Scene& scene, const Settings& settings) const override {
        auto costs = tile_tree_costs({scene, settings}, 6, false);
        for (const auto* entry : {"refit_embree", "collide_embree"})
            costs.push_back({entry, {}, {}, "nothing: the work of another library is not counted"});
        return costs;
    }

    AlgorithmStages do_build(const BuildContext& context) const override { return embree_stages(context); }
};

} // namespace

/// Intel's Embree, rtcCollide over one tree per body: the usual choice on a processor. A baseline for one
/// precision and one k, on device host.
const Traversal& embree() {
    static const Embree instance;
    return instance;
}

} // namespace tandem
