// SPDX-License-Identifier: MIT
#include "algorithms/answer/contact_reductions.h"

#include "algorithms/answer/wrench_sums.h"
#include "algorithms/kernels/sources.h"
#include "algorithms/parameters/table.h"
#include "backends/upload.h"

#include <bit>

namespace tandem {

namespace {

constexpr std::size_t sum_bytes = 4 * (4 * 7 + 2); ///< SUM_WORDS of wrenches.cl

} // namespace

ContactReduction::ContactReduction(const Bodies& bodies, LaunchShape shape) : bodies_(bodies), shape_(shape) {
    auto& device = bodies.device();
    compile_kernel(device, count_, defines());
    contacts_ = GrowableBuffer(
        device, {{"ids of all contacts", 8}, {"all contacts", 8 * real_bytes(bodies.geometry())}}, 0);
    table_ = GrowableBuffer(device, "contacts by body pair", 4, 0);
}

Defines ContactReduction::defines() const {
    auto defines = row_defines(bodies_.geometry(), shape_.group_size);
    define(defines, parameters::pair_layout, bodies_.pair_layout());
    return defines;
}

ContactRows ContactReduction::source(const AnswerBuffers& answer) {
    const auto capacity = answer.contacts.capacity();
    contacts_.reserve(capacity);
    return {contacts_.buffer(contact_ids), contacts_.buffer(contact_values), capacity};
}

void ContactReduction::launch(const AnswerBuffers& answer, const ContactRows& kept, std::uint64_t body_pairs,
                              const Status& status) {
    auto& device = bodies_.device();
    const StageScope scope(device, Stage::contact);
    // Half of the places stay free, so that a search meets a free one soon.
    const auto places = std::bit_ceil(2 * std::max<std::uint64_t>(body_pairs, 32));
    table_.reserve(places);
    device.clear(table_.buffer(), places * 4);
    do_launch({answer.pairs.buffer(), contacts_.buffer(contact_ids), contacts_.buffer(contact_values), kept,
               static_cast<std::uint32_t>(places), status});
    device.launch(count_, {1, shape_.group_size}, {.capacity = kept.capacity, .status = status.buffer()});
}

ClosestStage::ClosestStage(const Bodies& bodies, LaunchShape shape) : ContactReduction(bodies, shape) {
    compile_kernel(bodies.device(), find_, defines());
    compile_kernel(bodies.device(), keep_, defines());
}

void ClosestStage::do_launch(const Task& task) {
    auto& device = bodies_.device();
    device.launch(find_, grid(),
                  {.found = task.pairs,
                   .owners = bodies_.owners(),
                   .ids = bodies_.ids(),
                   .contact_ids = task.ids,
                   .contact_values = task.values,
                   .capacity = task.kept.capacity,
                   .table = table_.buffer(),
                   .places = task.places,
                   .status = task.status.buffer()});
    device.launch(keep_, grid(),
                  {.table = table_.buffer(),
                   .places = task.places,
                   .contact_ids = task.ids,
                   .contact_values = task.values,
                   .capacity = task.kept.capacity,
                   .kept_ids = task.kept.ids,
                   .kept_values = task.kept.values,
                   .status = task.status.buffer()});
}

WrenchStage::WrenchStage(const Bodies& bodies, LaunchShape shape) : ContactReduction(bodies, shape) {
    auto& device = bodies.device();
    compile_kernel(device, add_, defines());
    compile_kernel(device, write_, defines());
    arms_ = uploaded(device, packed_arms(body_arms(bodies.scene()), bodies.geometry()), "arms of bodies");
    sums_ = GrowableBuffer(device, "sums of wrenches", sum_bytes, 0);
}

void WrenchStage::do_launch(const Task& task) {
    auto& device = bodies_.device();
    sums_.reserve(task.places);
    device.clear(sums_.buffer(), task.places * sum_bytes);
    device.launch(add_, grid(),
                  {.found = task.pairs,
                   .owners = bodies_.owners(),
                   .ids = bodies_.ids(),
                   .contact_ids = task.ids,
                   .contact_values = task.values,
                   .capacity = task.kept.capacity,
                   .poses = bodies_.poses(),
                   .arms = arms_,
                   .table = table_.buffer(),
                   .places = task.places,
                   .sums = sums_.buffer(),
                   .status = task.status.buffer()});
    device.launch(write_, grid(),
                  {.found = task.pairs,
                   .owners = bodies_.owners(),
                   .contact_ids = task.ids,
                   .capacity = task.kept.capacity,
                   .arms = arms_,
                   .table = table_.buffer(),
                   .places = task.places,
                   .sums = sums_.buffer(),
                   .kept_ids = task.kept.ids,
                   .kept_values = task.kept.values,
                   .status = task.status.buffer()});
}

std::unique_ptr<ContactReduction> contact_reduction(Output output, const Bodies& bodies, LaunchShape shape) {
    if (output == Output::distances) return std::make_unique<ClosestStage>(bodies, shape);
    if (output == Output::wrenches) return std::make_unique<WrenchStage>(bodies, shape);
    return nullptr;
}

} // namespace tandem
