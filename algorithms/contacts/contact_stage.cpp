// SPDX-License-Identifier: MIT
#include "algorithms/contacts/contact_stage.h"

#include "algorithms/sources.h"

namespace tandem {

ContactStage::ContactStage(const DeviceScene& scene, const ContactSettings& settings, std::uint64_t capacity,
                           std::uint32_t groups)
    : scene_(scene), groups_(groups) {
    auto defines = row_defines(scene.geometry(), scene.group_size());
    const auto& source = kernel_source("algorithms/contacts/contacts.cl");
    digest_ = scene.device().compile(source, "digest_contacts", defines);
    defines["CONTACT_RULE"] = std::to_string(static_cast<int>(settings.rule));
    defines["DECIDED"] = settings.decision == DecisionPrecision::fp32 ? "0" : "1";
    generate_ = scene.device().compile(source, "generate_contacts", defines);
    if (settings.decision != DecisionPrecision::fp32)
        decision_ = std::make_unique<DecisionStage>(scene, settings.decision, groups);
    else
        no_verdicts_ = scene.device().allocate(1, "no verdicts");
    reserve(capacity);
}

void ContactStage::reserve(std::uint64_t count) {
    capacity_ = count;
    ids_ = {};
    values_ = {};
    ids_ = scene_.device().allocate(count * 8, "contact ids");
    values_ = scene_.device().allocate(count * 8 * real_bytes(scene_.geometry()), "contact values");
}

void ContactStage::launch(const Buffer& found, std::uint64_t first, std::uint64_t pair_capacity,
                          const Buffer& status) {
    if (decision_) decision_->launch(found, first, pair_capacity, status);
    const StageScope scope(scene_.device(), Stage::contact);
    const std::array<Argument, 13> arguments{found,
                                             static_cast<std::uint32_t>(first),
                                             static_cast<std::uint32_t>(pair_capacity),
                                             scene_.bodies(),
                                             scene_.poses(),
                                             scene_.tetrahedra(),
                                             scene_.vertices(),
                                             scene_.boundary(),
                                             ids_,
                                             values_,
                                             static_cast<std::uint32_t>(capacity_),
                                             decision_ ? decision_->verdicts() : no_verdicts_,
                                             status};
    scene_.device().launch(generate_, {groups_, scene_.group_size()}, arguments);
}

void ContactStage::launch_digest(const Buffer& found, const Buffer& status) {
    const StageScope scope(scene_.device(), Stage::contact);
    const std::array<Argument, 7> arguments{found, scene_.bodies(), scene_.tetrahedron_ids(),
                                            ids_,  values_,         static_cast<std::uint32_t>(capacity_),
                                            status};
    scene_.device().launch(digest_, {groups_, scene_.group_size()}, arguments);
}

} // namespace tandem
