// SPDX-License-Identifier: MIT
#include "algorithms/contacts/contact_stage.h"

#include "algorithms/sources.h"

#include <algorithm>

namespace tandem {

namespace {

/// As many groups as run at once with the registers of generate_contacts, 512 work-items on a GPU's unit:
/// each has then more pairs to make full steps of (recorded funnel: 104 to 54 us on an H200).
LaunchShape contact_shape(LaunchShape shape) {
    shape.groups = std::max(1u, shape.groups / 4);
    return shape;
}

} // namespace

ContactStage::ContactStage(const Bodies& bodies, const ContactSettings& settings, LaunchShape shape)
    : bodies_(bodies), shape_(contact_shape(shape)) {
    auto& device = bodies.device();
    auto defines = row_defines(bodies.geometry(), shape.group_size);
    define(defines, parameters::contact_rule, settings.rule);
    defines["DECIDED"] = settings.decision == DecisionPrecision::fp32 ? "0" : "1";
    generate_ =
        device.compile(kernel_source("algorithms/contacts/contacts.cl"), "generate_contacts", defines);
    if (settings.decision != DecisionPrecision::fp32)
        decision_ = std::make_unique<DecisionStage>(bodies, settings.decision, shape);
    else
        no_verdicts_ = device.allocate(1, "no verdicts");
}

void ContactStage::launch(const AnswerBuffers& answer, std::uint64_t first, std::uint64_t end,
                          const Status& status) {
    if (decision_) decision_->launch(answer.pairs.buffer(), first, end, status);
    const StageScope scope(bodies_.device(), Stage::contact);
    const std::array<Argument, 13> arguments{answer.pairs.buffer(),
                                             static_cast<std::uint32_t>(first),
                                             static_cast<std::uint32_t>(end),
                                             bodies_.row_table(),
                                             bodies_.poses(),
                                             bodies_.tetrahedra(),
                                             bodies_.vertices(),
                                             bodies_.boundary(),
                                             answer.contact_ids.buffer(),
                                             answer.contact_values.buffer(),
                                             answer.contact_ids.capacity(),
                                             decision_ ? decision_->verdicts() : no_verdicts_,
                                             status.buffer()};
    bodies_.device().launch(generate_, {shape_.groups, shape_.group_size}, arguments);
}

} // namespace tandem
