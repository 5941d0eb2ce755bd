// SPDX-License-Identifier: MIT
// Algorithm leaf_query with other defaults, so that tests that iterate the algorithms also cover its tree
// over all bodies. It keeps a tree for two frames.
#include "algorithms/leaf_query/leaf_query_parameters.h"
#include "algorithms/pipeline/stages.h"
#include "algorithms/traversal.h"

#include <algorithm>

namespace tandem {
namespace {

/// The setting with another default.
template<class T>
Setting<T> with_default(Setting<T> setting, T value) {
    setting.initial = static_cast<std::int64_t>(value);
    return setting;
}

class SceneLeaves final : public Traversal {
public:
    std::string_view name() const override { return "leaf_query_scene"; }
    std::string_view summary() const override { return "leaf_query with tree=scene and rebuild=2"; }
    std::span<const Parameter* const> parameters() const override {
        static const auto tree = with_default(leaf_query_parameters::tree, QueriedTree::scene);
        static const auto rebuild = with_default(leaf_query_parameters::rebuild, std::int64_t{2});
        static const auto all = [] {
            const auto given = algorithm("leaf_query").parameters();
            std::vector<const Parameter*> rows(given.begin(), given.end());
            std::ranges::replace(rows, static_cast<const Parameter*>(&leaf_query_parameters::tree),
                                 static_cast<const Parameter*>(&tree));
            std::ranges::replace(rows, static_cast<const Parameter*>(&leaf_query_parameters::rebuild),
                                 static_cast<const Parameter*>(&rebuild));
            return rows;
        }();
        return all;
    }
    std::span<const Preset> presets() const override { return algorithm("leaf_query").presets(); }
    std::span<const Counter> counters() const override { return algorithm("leaf_query").counters(); }

private:
    void do_check(const Settings&, const DeviceInfo&) const override {}
    AlgorithmStages do_build(const BuildContext& context) const override {
        return algorithm("leaf_query").build(context);
    }
};

const SceneLeaves scene_leaves;

} // namespace

[[maybe_unused]] static const bool listed = (add_algorithm(scene_leaves), true);

} // namespace tandem
