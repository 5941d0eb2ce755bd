// SPDX-License-Identifier: MIT
#include "algorithms/answer/order_stage.h"

#include "algorithms/parameters/table.h"
#include "algorithms/kernels/sources.h"
#include "backends/upload.h"
#include "base/error.h"

#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

/// Groups that sum counts: each adds up the sums of those before it.
constexpr std::uint32_t most_groups = 4096;

/// Number of tetrahedra in the bodies before each body, and in all.
std::vector<std::uint32_t> first_places(const Scene& scene) {
    std::vector<std::uint32_t> firsts;
    std::uint64_t places = 0;
    for (const auto& body : scene.bodies) {
        firsts.push_back(static_cast<std::uint32_t>(places));
        places += scene.meshes[body.mesh].tetrahedra.size();
    }
    if (places > std::numeric_limits<std::uint32_t>::max())
        throw DeviceError(
            fmt::format("setting order=canonical takes fewer than 2^32 tetrahedra, and the scene has {}; "
                        "leave it out",
                        places));
    firsts.push_back(static_cast<std::uint32_t>(places));
    return firsts;
}

/// Rows of keys, which kernels read in quads.
std::uint64_t whole_quads(std::uint32_t rows) { return (std::uint64_t{rows} + 3) / 4 * 4; }

/// The table `solids` of sort.cl. Places of tetrahedra that are not walked are 0 and not read.
std::vector<std::uint32_t> solids_by_place(const Bodies& bodies, const std::vector<std::uint32_t>& firsts) {
    const std::size_t words = bodies.pair_layout() == PairLayout::slots ? 1 : 2;
    std::vector<std::uint32_t> solids(words * firsts.back());
    for (std::uint32_t body = 0; body < bodies.count(); ++body) {
        const auto& ids = bodies.mesh(body).ids;
        for (std::uint32_t item = 0; item < ids.size(); ++item) {
            auto* const solid = &solids[words * (firsts[body] + ids[item])];
            if (words == 1) {
                solid[0] = bodies.first_slot(body) + item;
            } else {
                solid[0] = body;
                solid[1] = item;
            }
        }
    }
    return solids;
}

} // namespace

OrderStage::OrderStage(const Bodies& bodies, LaunchShape shape, bool contacts)
    : bodies_(bodies), shape_(shape) {
    auto& device = bodies.device();
    const auto firsts = first_places(bodies.scene());
    places_ = firsts.back();
    shape_.groups = std::min(shape_.groups, most_groups);
    auto defines = row_defines(bodies.geometry(), shape.group_size);
    define(defines, parameters::pair_layout, bodies.pair_layout());
    const auto compile = [&](auto&... kernels) { (compile_kernel(device, kernels, defines), ...); };
    compile(count_pairs_, sum_parts_, start_runs_, scatter_pairs_, sort_pairs_);
    const StageScope scope(device, Stage::write);
    firsts_ = uploaded(device, bytes_of(firsts), "first tetrahedra of bodies");
    solids_ = uploaded(device, bytes_of(solids_by_place(bodies, firsts)), "tetrahedra in canonical order");
    sums_ = device.allocate(shape_.groups * 4, "sums of counts");
    counts_ = GrowableBuffer(device, "counts by key", 4, 0);
    pairs_ = GrowableBuffer(device, {{"keys of pairs", 4}, {"places of pairs in runs", 4}}, 0);
    if (!contacts) return;
    compile(count_contacts_, scatter_contacts_, sort_contacts_, return_contacts_);
    contacts_ = GrowableBuffer(device,
                               {{"contacts to sort", 4},
                                {"keys of contacts", 4},
                                {"places of contacts in runs", 4},
                                {"ids of sorted contacts", 8},
                                {"values of sorted contacts", 8 * real_bytes(bodies.geometry())}},
                               0);
}

void OrderStage::begin_counts(std::uint32_t keys) {
    counts_.reserve(keys);
    bodies_.device().clear(counts_.buffer(), std::size_t{keys} * 4);
}

void OrderStage::start_runs(std::uint32_t keys, bool by_pair, const Status& status) {
    const auto run = [&]<class Arguments>(const KernelOf<Arguments>& kernel) {
        launch(kernel, Arguments{.counts = counts_.buffer(),
                                 .most = keys,
                                 .by_pair = std::uint32_t{by_pair ? 1u : 0u},
                                 .sums = sums_,
                                 .status = status.buffer()});
    };
    run(sum_parts_);
    run(start_runs_);
}

void OrderStage::sort_pairs(const Buffer& found, std::uint32_t capacity, const Status& status,
                            const Buffer& sorted) {
    const StageScope scope(bodies_.device(), Stage::sort);
    pairs_.reserve(whole_quads(capacity));
    const auto &keys = pairs_.buffer(0), &before = pairs_.buffer(1);
    begin_counts(places_);
    launch(count_pairs_, {.found = found,
                          .capacity = capacity,
                          .owners = bodies_.owners(),
                          .ids = bodies_.ids(),
                          .firsts = firsts_,
                          .counts = counts_.buffer(),
                          .before = before,
                          .status = status.buffer()});
    start_runs(places_, false, status);
    launch(scatter_pairs_, {.found = found,
                            .capacity = capacity,
                            .owners = bodies_.owners(),
                            .ids = bodies_.ids(),
                            .firsts = firsts_,
                            .places = counts_.buffer(),
                            .before = before,
                            .keys = keys,
                            .status = status.buffer()});
    launch(sort_pairs_, {.places = counts_.buffer(),
                         .count = places_,
                         .capacity = capacity,
                         .keys = keys,
                         .solids = solids_,
                         .found = sorted,
                         .status = status.buffer()});
}

void OrderStage::sort_contacts(const AnswerBuffers& answer, const Status& status) {
    const StageScope scope(bodies_.device(), Stage::sort);
    const auto& found = answer.contacts;
    const auto pairs = answer.pairs.capacity();
    const auto &ids = found.buffer(contact_ids), &values = found.buffer(contact_values);
    contacts_.reserve(whole_quads(found.capacity()));
    const auto &rows = contacts_.buffer(0), &keys = contacts_.buffer(1), &before = contacts_.buffer(2);
    const auto &sorted_ids = contacts_.buffer(3), &sorted_values = contacts_.buffer(4);
    begin_counts(pairs);
    launch(count_contacts_, {.contact_ids = ids,
                             .capacity = found.capacity(),
                             .counts = counts_.buffer(),
                             .before = before,
                             .status = status.buffer()});
    start_runs(pairs, true, status);
    launch(scatter_contacts_, {.contact_ids = ids,
                               .capacity = found.capacity(),
                               .places = counts_.buffer(),
                               .before = before,
                               .rows = rows,
                               .keys = keys,
                               .status = status.buffer()});
    launch(sort_contacts_, {.places = counts_.buffer(),
                            .pair_capacity = pairs,
                            .capacity = found.capacity(),
                            .rows = rows,
                            .keys = keys,
                            .contact_ids = ids,
                            .contact_values = values,
                            .sorted_ids = sorted_ids,
                            .sorted_values = sorted_values,
                            .status = status.buffer()});
    launch(return_contacts_, {.sorted_ids = sorted_ids,
                              .sorted_values = sorted_values,
                              .capacity = found.capacity(),
                              .contact_ids = ids,
                              .contact_values = values,
                              .status = status.buffer()});
}

} // namespace tandem
