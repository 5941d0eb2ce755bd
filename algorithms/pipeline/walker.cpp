// SPDX-License-Identifier: MIT
#include "algorithms/pipeline/walker.h"

#include "algorithms/parameters/table.h"

namespace tandem {

void WalkBuild::add_to(Defines& defines) const {
    define(defines, parameters::output, has_pairs(output) ? Output::pairs : output);
    define(defines, parameters::pair_layout, pair_layout);
    defines["COUNT_WORK"] = counting ? "1" : "0";
    defines["WINDOWED"] = windowed ? "1" : "0";
    define(defines, parameters::self, self ? SelfPairs::on : SelfPairs::off);
}

} // namespace tandem
