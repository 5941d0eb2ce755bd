// SPDX-License-Identifier: MIT
#include "harness/plans/run_options.h"

#include "harness/plans/cell_groups.h"

namespace tandem {

PlanFile plan_of(const RunOptions& options) {
    Product given{options.scenes, {}, options.request};
    if (!options.frames.empty()) given.frames = {options.frames};
    // An empty name stands for --mesh; without it open_scene() reports that there is no scene.
    if (given.scenes.empty()) given.scenes.emplace_back();
    PlanFile plan;
    if (options.plan) {
        plan = *options.plan;
        replace(plan, given);
    } else {
        plan.products = {given};
    }
    return plan;
}

} // namespace tandem
