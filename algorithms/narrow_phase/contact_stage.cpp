// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/contact_stage.h"

#include "algorithms/narrow_phase/open_pairs.clh"
#include "algorithms/kernels/sources.h"

#include <algorithm>
#include <span>

namespace tandem {

namespace {

/// Maximum number of pairs in a round of all three kernels.
constexpr std::uint64_t most_waiting = std::uint64_t{1} << OPEN_PAIR_BITS;
/// Minimum capacity of the lists when memory is short.
constexpr std::uint64_t least_waiting = 1024;
/// Pairs that are worth a work-item of a processor: a few packs.
constexpr std::uint64_t pairs_an_item = 32;

/// Groups are no larger than the local memory of this stage's kernels allows.
LaunchShape shape_for(LaunchShape shape, Precision precision) {
    const std::uint32_t largest = precision == Precision::fp64 ? 64 : 128;
    const auto items = std::uint64_t{shape.groups} * shape.group_size;
    const auto size = std::min(shape.group_size, largest);
    return {size, static_cast<std::uint32_t>(std::max<std::uint64_t>(1, items / size))};
}

} // namespace

ContactStage::ContactStage(const Bodies& bodies, const ContactSettings& settings, LaunchShape shape,
                           Launches launches)
    : bodies_(bodies),
      has_near_(has_near_pairs(settings.rule)),
      has_polygons_(needs_pressures(settings.rule)),
      margin_(margin_of(settings)),
      shape_(shape_for(shape, bodies.geometry().precision)),
      few_shape_(shape_) {
    few_shape_.groups = std::max(1u, few_shape_.groups / 2);
    auto& device = bodies.device();
    auto defines = row_defines(bodies.geometry(), shape_.group_size);
    define(defines, parameters::pair_layout, bodies_.pair_layout());
    define(defines, parameters::contact_rule, settings.rule);
    defines["BOUNDARY_NEEDED"] = std::to_string(boundaries_needed(settings.rule));
    // The walk leaves out pairs without a common pressure, if nodes bound pressures.
    defines["PRESSURES_NEEDED"] =
        needs_pressures(settings.rule) && !bodies.geometry().pressure_slab ? "1" : "0";
    if (has_verdicts(settings.decision)) decision_ = std::make_unique<DecisionStage>(bodies, settings, shape);
    const auto decided = [&](bool by_verdicts) { return decided_define(settings.decision, by_verdicts); };
    if (launches == Launches::apart) {
        defines["DECIDED"] = decided(decision_ && !decides_open());
        compile_kernel(device, certify_, defines);
        defines["DECIDED"] = decided(decision_ != nullptr);
        compile_kernel(device, separate_, defines);
        defines["AT_ONCE"] = "0";
        compile_kernel(device, generate_, defines);
    }
    if (launches == Launches::at_once || device.info().is_gpu) {
        defines["DECIDED"] = decided(decision_ != nullptr);
        defines["AT_ONCE"] = "1";
        compile_kernel(device, at_once_, defines);
    }
    nothing_ = device.allocate(4, "nothing");
    std::vector<Column> lists{{"pairs to be tested", 4}, {"pairs that meet", 4}};
    if (has_near_) lists.push_back({"pairs apart", 4});
    waiting_ = GrowableBuffer(device, lists, 0);
}

/// One of the lists, or an empty buffer where there is none.
const Buffer& ContactStage::list(std::size_t number) const {
    const bool exists = waiting_.capacity() > 0 && (number != LIST_NEAR || has_near_);
    return exists ? waiting_.buffer(number) : nothing_;
}

/// Reserves lists for `pairs` pairs, or for fewer when memory is short, which takes more launches.
void ContactStage::reserve_lists(std::uint64_t pairs) {
    for (auto rows = std::min(pairs, most_waiting); rows > waiting_.capacity(); rows /= 2) {
        try {
            waiting_.reserve(rows);
        } catch (const OutOfMemory&) {
            if (rows <= least_waiting) throw;
        }
    }
}

void ContactStage::reserve(std::uint64_t pairs) {
    if (decision_) decision_->reserve(pairs);
    if (generate_) reserve_lists(pairs);
}

/// More groups than run at once where a GPU has many pairs for each: pairs take unlike times, and a group
/// that ends makes room for another. On a processor no more than have work, because each costs time.
LaunchShape ContactStage::apart_shape() {
    auto shape = shape_;
    if (!expected_) return shape;
    const std::uint64_t many = 4 * std::uint64_t{shape.groups} * shape.group_size;
    if (!bodies_.device().info().is_gpu)
        shape.groups = groups_.groups_for(*expected_ / (pairs_an_item * shape.group_size), shape.groups);
    else if (*expected_ >= many)
        shape.groups *= 2;
    return shape;
}

/// Lists the pairs that meet. Both lists must be empty before.
void ContactStage::find_meeting(const Range& range, LaunchShape shape) {
    auto& device = bodies_.device();
    const Grid grid{shape.groups, shape.group_size};
    const auto& status = range.status;
    const kernels::certify::CertifyPairs certify{.found = range.pairs,
                                                 .first = range.first,
                                                 .pair_capacity = range.end,
                                                 .owners = bodies_.owners(),
                                                 .poses = bodies_.poses(),
                                                 .tetrahedra = bodies_.tetrahedra(),
                                                 .vertices = bodies_.vertices(),
                                                 .boundary = bodies_.boundary(),
                                                 .verdicts = verdicts(),
                                                 .margin = margin_,
                                                 .open = list(LIST_OPEN),
                                                 .meeting = list(LIST_MEETING),
                                                 .near = list(LIST_NEAR),
                                                 .status = status.buffer()};
    device.launch(certify_, grid, certify);
    if (has_polygons_) return;
    if (decides_open()) decision_->launch_open(range.pairs, range.first, range.end, list(LIST_OPEN), status);
    const kernels::separate::SeparatePairs separate{.found = range.pairs,
                                                    .first = range.first,
                                                    .owners = bodies_.owners(),
                                                    .poses = bodies_.poses(),
                                                    .tetrahedra = bodies_.tetrahedra(),
                                                    .vertices = bodies_.vertices(),
                                                    .verdicts = verdicts(),
                                                    .open = list(LIST_OPEN),
                                                    .meeting = list(LIST_MEETING),
                                                    .near = list(LIST_NEAR),
                                                    .status = status.buffer()};
    device.launch(separate_, grid, separate);
}

/// Makes contacts of the listed pairs that meet, or of all in the range.
void ContactStage::generate(const KernelOf<kernels::contacts::GenerateContacts>& kernel, LaunchShape shape,
                            const Range& range, const ContactRows& contacts) {
    const kernels::contacts::GenerateContacts arguments{.found = range.pairs,
                                                        .first = range.first,
                                                        .pair_capacity = range.end,
                                                        .owners = bodies_.owners(),
                                                        .poses = bodies_.poses(),
                                                        .tetrahedra = bodies_.tetrahedra(),
                                                        .vertices = bodies_.vertices(),
                                                        .boundary = bodies_.boundary(),
                                                        .verdicts = verdicts(),
                                                        .margin = margin_,
                                                        .meeting = list(LIST_MEETING),
                                                        .near = list(LIST_NEAR),
                                                        .contact_ids = contacts.ids,
                                                        .contact_values = contacts.values,
                                                        .contact_capacity = contacts.capacity,
                                                        .status = range.status.buffer()};
    bodies_.device().launch(kernel, {shape.groups, shape.group_size}, arguments);
}

void ContactStage::launch(const Buffer& pairs, const ContactRows& contacts, std::uint64_t first,
                          std::uint64_t end, const Status& status) {
    auto& device = bodies_.device();
    const StageScope scope(device, Stage::contact);
    // With at most one pair per running work-item, the latency of one pair and the number of launches
    // dominate.
    const bool few = expected_ && *expected_ <= std::uint64_t{few_shape_.groups} * few_shape_.group_size / 2;
    const bool at_once = at_once_ && (few || !generate_);
    if (decision_) decision_->reserve(end);
    if (decision_ && (at_once || !decides_open())) decision_->launch(pairs, first, end, status);
    if (at_once) {
        auto shape = few_shape_;
        const auto size = shape.group_size;
        if (few) shape.groups = groups_.groups_for((*expected_ + size - 1) / size, shape.groups);
        generate(at_once_, shape,
                 {pairs, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end), status},
                 contacts);
        return;
    }
    reserve_lists(end - first);
    const auto shape = apart_shape();
    const auto lengths = std::span(status.words()).subspan(STATUS_WAITING, STATUS_WAITING_WORDS);
    bool waiting =
        std::ranges::any_of(lengths, [](auto length) { return length != 0; }); // of an earlier launch
    for (auto from = first; from < end; from += waiting_.capacity()) {
        if (waiting) device.clear(status.buffer(), STATUS_WAITING_WORDS * 4, STATUS_WAITING * 4);
        const Range range{pairs, static_cast<std::uint32_t>(from),
                          static_cast<std::uint32_t>(std::min(end, from + waiting_.capacity())), status};
        find_meeting(range, shape);
        generate(generate_, shape, range, contacts);
        waiting = true;
    }
}

} // namespace tandem
