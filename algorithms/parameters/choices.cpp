// SPDX-License-Identifier: MIT
// Checks that the numbers of choices.h and of choices.clh are equal.
#include "algorithms/parameters/choices.clh"
#include "algorithms/parameters/choices.h"

namespace tandem {

namespace {

template<class Choice>
constexpr bool is(Choice choice, int number) {
    return static_cast<int>(choice) == number;
}

static_assert(is(Axes::standard, AXES_STANDARD) && is(Axes::coordinate, AXES_COORDINATE));
static_assert(is(Rounding::nearest, ROUNDING_NEAREST) && is(Rounding::safe, ROUNDING_SAFE)
              && is(Rounding::published, ROUNDING_PUBLISHED) && is(Rounding::directed, ROUNDING_DIRECTED));
static_assert(is(Placement::rounded, PLACEMENT_ROUNDED) && is(Placement::exact, PLACEMENT_EXACT));
static_assert(is(Motion::none, MOTION_NONE) && is(Motion::linear, MOTION_LINEAR));
static_assert(is(Output::pairs, OUTPUT_PAIRS) && is(Output::count, OUTPUT_COUNT)
              && is(Output::digest, OUTPUT_DIGEST));
static_assert(is(SelfPairs::off, SELF_OFF) && is(SelfPairs::on, SELF_ON)
              && is(SelfPairs::deformable, SELF_DEFORMABLE));
static_assert(is(PairLayout::items, PAIR_ITEMS) && is(PairLayout::slots, PAIR_SLOTS));
static_assert(is(Slabs::three, SLABS_THREE) && is(Slabs::all, SLABS_ALL));

} // namespace

} // namespace tandem
