// SPDX-License-Identifier: MIT
#include "scenes/hard/families.h"

#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// The catalogue is sorted by row, since groups are not contiguous in it.
std::vector<HardFamily> all_families() {
    std::vector<HardFamily> all;
    for (const auto group : {hard::bounding_families(), hard::tolerance_families(), hard::decision_families(),
                             hard::shape_families(), hard::contact_families(), hard::deforming_families(),
                             hard::capacity_families(), hard::one_body_families(), hard::moving_families(),
                             hard::turning_families(), hard::distant_families()})
        all.insert(all.end(), group.begin(), group.end());
    std::ranges::sort(all, {}, &HardFamily::row);
    return all;
}

} // namespace

std::string_view name_of(HardTruth truth) {
    constexpr std::string_view names[] = {"construction", "oracle", "program", "geometry"};
    return names[static_cast<unsigned>(truth)];
}

std::span<const HardFamily> hard_families() {
    static const auto families = all_families();
    return families;
}

const HardFamily& hard_family(std::string_view name) {
    std::vector<std::string> names;
    for (const auto& family : hard_families()) {
        if (family.name == name) return family;
        names.emplace_back(family.name);
    }
    throw InputError(unknown("family of hard cases", name, names));
}

void check_difficulty(const HardFamily& family, double difficulty) {
    const auto& knob = family.knob;
    if (!(difficulty >= knob.least && difficulty <= knob.most))
        throw InputError(fmt::format("hard:{}: difficulty={} is impossible; give a number from {} to {} ({})",
                                     family.name, difficulty, knob.least, knob.most, knob.meaning));
}

HardPair hard_pair(const HardFamily& family, std::uint64_t seed, std::uint64_t index, double difficulty) {
    Random mixer(seed ^ std::uint64_t{family.row} << 56);
    Random random(mixer.next() + (family.twins ? index / 2 : index) * 0xd1342543de82ef95u);
    return family.pair(random, difficulty, index);
}

} // namespace tandem
