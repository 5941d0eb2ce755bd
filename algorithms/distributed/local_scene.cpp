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
    void expand_sorted(const Buffer& expanded) const override { part_->expand_sorted(expanded); }
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
    auto local_scene = std::make_shared<Scene>();
    local_scene->name = scene.name;
    local_scene->key = scene.key;
    local_scene->units = scene.units;
    local_scene->frame_count = scene.frame_count;
    local_scene->digest = scene.digest;
    local_scene->numbers = bodies;
    local_scene->world_size = scene.world_size;
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> meshes(scene.meshes.size(), none); // local number by number in the whole scene
    for (const auto number : bodies) {
        auto body = scene.bodies[number];
        auto& mesh = meshes[body.mesh];
        if (mesh == none) {
            mesh = static_cast<std::uint32_t>(local_scene->meshes.size());
            local_scene->meshes.push_back(scene.meshes[body.mesh]);
            if (!scene.shifts.empty()) local_scene->shifts.push_back(scene.shifts[body.mesh]);
        }
        body.mesh = mesh;
        local_scene->bodies.push_back(body);
    }
    for (const auto& [a, b] : scene.never_meet)
        if (std::ranges::binary_search(bodies, a) && std::ranges::binary_search(bodies, b))
            local_scene->never_meet.push_back({static_cast<std::uint32_t>(local_index(*local_scene, a)),
                                               static_cast<std::uint32_t>(local_index(*local_scene, b))});
    return local_scene;
}

std::size_t local_index(const Scene& local_scene, std::uint32_t number) {
    const auto& numbers = local_scene.numbers;
    return static_cast<std::size_t>(std::ranges::lower_bound(numbers, number) - numbers.begin());
}

Subdomain to_local(const Scene& local_scene, const Subdomain& subdomain) {
    const auto local_indices = [&](const std::vector<std::uint32_t>& bodies) {
        std::vector<std::uint32_t> numbers;
        numbers.reserve(bodies.size());
        for (const auto body : bodies)
            numbers.push_back(static_cast<std::uint32_t>(local_index(local_scene, body)));
        return numbers;
    };
    return {local_indices(subdomain.own), local_indices(subdomain.ghosts)};
}

std::shared_ptr<const AnswerPart> owning_part(std::shared_ptr<const AnswerPart> part,
                                              std::shared_ptr<const Scene> scene) {
    return std::make_shared<OwningPart>(std::move(part), std::move(scene));
}

} // namespace tandem
