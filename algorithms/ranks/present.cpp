// SPDX-License-Identifier: MIT
#include "algorithms/ranks/present.h"

namespace tandem {

namespace {

class KeptPart final : public AnswerPart {
public:
    KeptPart(std::shared_ptr<const AnswerPart> part, std::shared_ptr<const Scene> scene)
        : scene_(std::move(scene)), part_(std::move(part)) {}

    PairBuffer pairs() const override { return part_->pairs(); }
    void expand(std::uint64_t first, std::uint64_t count, const Buffer& expanded) const override {
        part_->expand(first, count, expanded);
    }
    Digest digest() const override { return part_->digest(); }
    Digest contact_digest() const override { return part_->contact_digest(); }
    void append_pairs(std::vector<Pair>& pairs) const override { part_->append_pairs(pairs); }
    void append_contacts(std::vector<ContactPoint>& contacts) const override {
        part_->append_contacts(contacts);
    }
    void count_by_body(std::vector<std::uint64_t>& counts) const override { part_->count_by_body(counts); }

private:
    std::shared_ptr<const Scene> scene_; // outlives the part
    std::shared_ptr<const AnswerPart> part_;
};

} // namespace

std::shared_ptr<const Scene> scene_of(const Scene& scene, const std::vector<bool>& is_present) {
    auto part = std::make_shared<Scene>();
    part->name = scene.name;
    part->key = scene.key;
    part->units = scene.units;
    part->frame_count = scene.frame_count;
    part->frame = scene.frame;
    part->digest = scene.digest;
    std::vector<bool> is_used(scene.meshes.size());
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        if (is_present[body]) is_used[scene.bodies[body].mesh] = true;
    for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh)
        part->meshes.push_back(is_used[mesh] ? scene.meshes[mesh] : Mesh{});
    part->meshes.emplace_back();
    const auto nothing = static_cast<std::uint32_t>(scene.meshes.size());
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        part->bodies.push_back(is_present[body] ? scene.bodies[body] : Body{.mesh = nothing, .fixed = true});
    return part;
}

std::shared_ptr<const AnswerPart> kept_part(std::shared_ptr<const AnswerPart> part,
                                            std::shared_ptr<const Scene> scene) {
    return std::make_shared<KeptPart>(std::move(part), std::move(scene));
}

} // namespace tandem
