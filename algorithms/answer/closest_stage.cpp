// SPDX-License-Identifier: MIT
#include "algorithms/answer/closest_stage.h"

#include "algorithms/kernels/sources.h"
#include "algorithms/parameters/table.h"

#include <bit>

namespace tandem {

ClosestStage::ClosestStage(const Bodies& bodies, LaunchShape shape) : bodies_(bodies), shape_(shape) {
    auto& device = bodies.device();
    auto defines = row_defines(bodies.geometry(), shape.group_size);
    define(defines, parameters::pair_layout, bodies.pair_layout());
    compile_kernel(device, find_, defines);
    compile_kernel(device, keep_, defines);
    compile_kernel(device, count_, defines);
    contacts_ = GrowableBuffer(
        device, {{"ids of all distances", 8}, {"all distances", 8 * real_bytes(bodies.geometry())}}, 0);
    table_ = GrowableBuffer(device, "closest contacts by body pair", 4, 0);
}

ContactRows ClosestStage::source(const AnswerBuffers& answer) {
    const auto capacity = answer.contacts.capacity();
    contacts_.reserve(capacity);
    return {contacts_.buffer(contact_ids), contacts_.buffer(contact_values), capacity};
}

void ClosestStage::launch(const AnswerBuffers& answer, const ContactRows& kept, std::uint64_t body_pairs,
                          const Status& status) {
    auto& device = bodies_.device();
    const StageScope scope(device, Stage::contact);
    // Half of the places stay free, so that a search meets a free one soon.
    const auto places = std::bit_ceil(2 * std::max<std::uint64_t>(body_pairs, 32));
    table_.reserve(places);
    const auto &ids = contacts_.buffer(contact_ids), &values = contacts_.buffer(contact_values);
    const auto& table = table_.buffer();
    const Grid grid{shape_.groups, shape_.group_size};
    device.clear(table, places * 4);
    device.launch(find_, grid,
                  {.found = answer.pairs.buffer(),
                   .owners = bodies_.owners(),
                   .ids = bodies_.ids(),
                   .contact_ids = ids,
                   .contact_values = values,
                   .capacity = kept.capacity,
                   .table = table,
                   .places = static_cast<std::uint32_t>(places),
                   .status = status.buffer()});
    device.launch(keep_, grid,
                  {.table = table,
                   .places = static_cast<std::uint32_t>(places),
                   .contact_ids = ids,
                   .contact_values = values,
                   .capacity = kept.capacity,
                   .kept_ids = kept.ids,
                   .kept_values = kept.values,
                   .status = status.buffer()});
    device.launch(count_, {1, shape_.group_size}, {.capacity = kept.capacity, .status = status.buffer()});
}

} // namespace tandem
