// SPDX-License-Identifier: MIT
#include "algorithms/distributed/local_scene.h"

#include <algorithm>
#include <limits>

namespace tandem {

namespace {

class OwningPart final : public AnswerPart {
public:
    OwningPart(std::shared_ptr<const AnswerPart> part, std::shared_ptr<const Scene> scene)
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

std::shared_ptr<const Scene> local_subscene(const Scene& scene, const std::vector<std::uint32_t>& bodies) {
    auto part = std::make_shared<Scene>();
    part->name = scene.name;
    part->key = scene.key;
    part->units = scene.units;
    part->frame_count = scene.frame_count;
    part->digest = scene.digest;
    part->numbers = bodies;
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> meshes(scene.meshes.size(), none); // by the scene's number of it: the part's
    for (const auto number : bodies) {
        auto body = scene.bodies[number];
        auto& mesh = meshes[body.mesh];
        if (mesh == none) {
            mesh = static_cast<std::uint32_t>(part->meshes.size());
            part->meshes.push_back(scene.meshes[body.mesh]);
        }
        body.mesh = mesh;
        part->bodies.push_back(body);
    }
    return part;
}

std::size_t local_index(const Scene& part, std::uint32_t number) {
    return static_cast<std::size_t>(std::ranges::lower_bound(part.numbers, number) - part.numbers.begin());
}

Subdomain to_local(const Scene& part, const Subdomain& subdomain) {
    const auto local_indices = [&](const std::vector<std::uint32_t>& bodies) {
        std::vector<std::uint32_t> numbers;
        numbers.reserve(bodies.size());
        for (const auto body : bodies) numbers.push_back(static_cast<std::uint32_t>(local_index(part, body)));
        return numbers;
    };
    return {local_indices(subdomain.own), local_indices(subdomain.ghosts)};
}

std::shared_ptr<const AnswerPart> owning_part(std::shared_ptr<const AnswerPart> part,
                                              std::shared_ptr<const Scene> scene) {
    return std::make_shared<OwningPart>(std::move(part), std::move(scene));
}

} // namespace tandem
