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

/// Tables of sort.cl. Places of tetrahedra that are not walked have no solid, and are not read.
struct Tables {
    std::vector<std::uint32_t> solids; ///< by place, the tetrahedron's words in pairs
    std::vector<std::uint32_t> places; ///< by slot, or by item of the scene
};

Tables tables_of(const Bodies& bodies, const std::vector<std::uint32_t>& firsts) {
    const bool slots = bodies.pair_layout() == PairLayout::slots;
    Tables tables;
    tables.solids.resize((slots ? std::size_t{1} : 2) * firsts.back());
    tables.places.resize(slots ? 0 : firsts.back());
    for (std::uint32_t body = 0; body < bodies.count(); ++body) {
        const auto& ids = bodies.mesh(body).ids;
        const auto first_slot = slots ? bodies.first_slot(body) : 0;
        const auto first = slots ? first_slot : firsts[body];
        if (tables.places.size() < std::size_t{first} + ids.size())
            tables.places.resize(std::size_t{first} + ids.size());
        for (std::uint32_t item = 0; item < ids.size(); ++item) {
            const auto place = firsts[body] + ids[item];
            tables.places[first + item] = place;
            if (slots) {
                tables.solids[place] = first_slot + item;
            } else {
                tables.solids[2 * std::size_t{place}] = body;
                tables.solids[2 * std::size_t{place} + 1] = item;
            }
        }
    }
    return tables;
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
    const auto tables = tables_of(bodies, firsts);
    solids_ = uploaded(device, bytes_of(tables.solids), "tetrahedra in canonical order");
    table_ = uploaded(device, bytes_of(tables.places), "places in canonical order");
    sums_ = device.allocate(shape_.groups * 4, "sums of counts");
    counts_ = GrowableBuffer(device, "counts by key", 4, 0);
    pairs_ = GrowableBuffer(device, {{"keys of pairs", 4}, {"places of pairs in runs", 4}}, 0);
    if (!contacts) return;
    compile(mark_contacts_, place_contacts_);
    masks_ = GrowableBuffer(device, {{"features of contacts by pair", 8}, {"first contacts of pairs", 4}}, 0);
    contacts_ = GrowableBuffer(
        device,
        {{"ids of contacts to sort", 8}, {"values of contacts to sort", 8 * real_bytes(bodies.geometry())}},
        0);
}

void OrderStage::start_runs(const Buffer& counts, std::uint32_t keys, bool by_pair, const Status& status,
                            const Buffer& starts) {
    const std::uint32_t word = by_pair ? 1 : 0;
    launch(sum_parts_,
           {.counts = counts, .most = keys, .by_pair = word, .sums = sums_, .status = status.buffer()});
    launch(start_runs_, {.counts = counts,
                         .most = keys,
                         .by_pair = word,
                         .sums = sums_,
                         .starts = starts,
                         .status = status.buffer()});
}

void OrderStage::sort_pairs(const Buffer& found, std::uint32_t capacity, const Status& status,
                            const Buffer& sorted) {
    const StageScope scope(bodies_.device(), Stage::sort);
    pairs_.reserve(whole_quads(capacity));
    const auto &keys = pairs_.buffer(0), &before = pairs_.buffer(1);
    counts_.reserve(places_);
    const auto& counts = counts_.buffer();
    bodies_.device().clear(counts, std::size_t{places_} * 4);
    launch(count_pairs_, {.found = found,
                          .capacity = capacity,
                          .firsts = firsts_,
                          .places = table_,
                          .counts = counts,
                          .before = before,
                          .status = status.buffer()});
    start_runs(counts, places_, false, status, counts);
    launch(scatter_pairs_, {.found = found,
                            .capacity = capacity,
                            .firsts = firsts_,
                            .places = table_,
                            .starts = counts,
                            .before = before,
                            .keys = keys,
                            .status = status.buffer()});
    launch(sort_pairs_, {.run_starts = counts,
                         .count = places_,
                         .capacity = capacity,
                         .keys = keys,
                         .solids = solids_,
                         .found = sorted,
                         .status = status.buffer()});
}

ContactRows OrderStage::unsorted(const AnswerBuffers& answer) {
    const auto capacity = answer.contacts.capacity();
    contacts_.reserve(capacity);
    masks_.reserve(answer.pairs.capacity());
    return {contacts_.buffer(contact_ids), contacts_.buffer(contact_values), capacity};
}

void OrderStage::sort_contacts(const AnswerBuffers& answer, bool reduced, const Status& status) {
    const std::uint32_t word = reduced ? 1 : 0;
    const StageScope scope(bodies_.device(), Stage::sort);
    const auto pairs = answer.pairs.capacity();
    const auto &masks = masks_.buffer(0), &starts = masks_.buffer(1);
    const auto &ids = contacts_.buffer(contact_ids), &values = contacts_.buffer(contact_values);
    bodies_.device().clear(masks, std::size_t{pairs} * 8);
    launch(mark_contacts_, {.contact_ids = ids,
                            .capacity = answer.contacts.capacity(),
                            .reduced = word,
                            .masks = masks,
                            .status = status.buffer()});
    start_runs(masks, pairs, true, status, starts);
    launch(place_contacts_, {.contact_ids = ids,
                             .contact_values = values,
                             .capacity = answer.contacts.capacity(),
                             .reduced = word,
                             .masks = masks,
                             .starts = starts,
                             .sorted_ids = answer.contacts.buffer(contact_ids),
                             .sorted_values = answer.contacts.buffer(contact_values),
                             .status = status.buffer()});
}

} // namespace tandem
