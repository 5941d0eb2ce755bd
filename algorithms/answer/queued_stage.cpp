// SPDX-License-Identifier: MIT
#include "algorithms/answer/queued_stage.h"

#include "algorithms/kernels/sources.h"
#include "algorithms/parameters/table.h"
#include "backends/upload.h"

namespace tandem {

namespace {

std::vector<std::uint32_t> rows_of(const std::vector<Limit>& limits) {
    std::vector<std::uint32_t> rows;
    for (const auto& [counter, most] : limits) rows.insert(rows.end(), {counter, most});
    return rows;
}

} // namespace

QueuedStage::QueuedStage(const Bodies& bodies, LaunchShape shape, std::shared_ptr<const AnswerBuffers> answer,
                         bool stores)
    : bodies_(bodies), shape_(shape), answer_(std::move(answer)) {
    auto& device = bodies.device();
    auto defines = row_defines(bodies.geometry(), shape.group_size);
    define(defines, parameters::pair_layout, bodies.pair_layout());
    compile_kernel(device, end_, defines);
    frame_.counts = device.allocate((QUEUED_WORDS + STATUS_WORDS) * 4, "counts of a queued frame");
    if (stores) {
        compile_kernel(device, name_, defines);
        frame_.pair_capacity = answer_->pairs.capacity();
        frame_.pairs = device.allocate(frame_.pair_capacity * sizeof(Pair), "pairs of a queued frame");
    }
    if (answer_->contacts.capacity() == 0) return;
    frame_.contact_capacity = answer_->contacts.capacity();
    frame_.contact_ids = answer_->contacts.buffer(contact_ids);
    frame_.contact_values = answer_->contacts.buffer(contact_values);
}

void QueuedStage::set_limits(std::vector<Limit> limits) {
    if (frame_.pairs) limits.push_back({STATUS_PAIRS, answer_->pairs.capacity()});
    if (frame_.contact_ids) limits.push_back({STATUS_CONTACTS, answer_->contacts.capacity()});
    limit_count_ = static_cast<std::uint32_t>(limits.size());
    limits_ = uploaded(bodies_.device(), bytes_of(rows_of(limits)), "limits of a queued frame");
}

void QueuedStage::launch(const Status& status) const {
    auto& device = bodies_.device();
    const StageScope scope(device, Stage::postprocess);
    if (name_) {
        const kernels::queued::NamePairs name{.found = answer_->pairs.buffer(),
                                              .capacity = answer_->pairs.capacity(),
                                              .owners = bodies_.owners(),
                                              .ids = bodies_.ids(),
                                              .expanded = frame_.pairs,
                                              .status = status.buffer()};
        device.launch(name_, {shape_.groups, shape_.group_size}, name);
    }
    const kernels::queued::EndFrame end{
        .limits = limits_, .limit_count = limit_count_, .status = status.buffer(), .counts = frame_.counts};
    device.launch(end_, {1, shape_.group_size}, end);
}

std::optional<Status::Words> QueuedStage::read() const {
    const StageScope scope(bodies_.device(), Stage::read);
    std::array<std::uint32_t, QUEUED_WORDS + STATUS_WORDS> all{};
    bodies_.device().download(frame_.counts, std::as_writable_bytes(std::span(all)));
    if (all[QUEUED_FLAG] != 0) return std::nullopt;
    Status::Words words;
    std::ranges::copy(std::span(all).subspan(QUEUED_WORDS), words.begin());
    return words;
}

} // namespace tandem
