// SPDX-License-Identifier: MIT
#include "algorithms/broad_phase/body_pairs.h"

#include "algorithms/bodies/bodies.h"
#include "algorithms/parameters/table.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

BodyPairs::BodyPairs(const BuildContext& context, const Hierarchy& hierarchy, Status::Writes writes)
    : hierarchy_(hierarchy),
      shape_(context.shape),
      bodies_(context.bodies),
      self_(context.settings[parameters::self]),
      method_(context.settings[parameters::broad]),
      first_capacity_(static_cast<std::uint64_t>(context.settings[parameters::body_pair_capacity])),
      device_(context.device),
      scene_(context.scene),
      geometry_(context.bodies.geometry()),
      writes_(writes),
      rows_(context.device, "body pairs", sizeof(BodyPair), 0) {
    if (context.settings.has(parameters::first_body_pair)) {
        first_ = static_cast<std::size_t>(context.settings[parameters::first_body_pair]);
        most_ = static_cast<std::size_t>(context.settings[parameters::most_body_pairs]);
    }
    if (method_ == Broad::device)
        make_stage();
    else
        broad_.emplace(context.scene, geometry_, method_, self_);
}

void BodyPairs::make_stage() {
    if (stage_) return;
    stage_ = std::make_unique<BroadStage>(bodies_, hierarchy_.volumes(), shape_, self_);
    const auto rows = std::clamp<std::uint64_t>(stage_->most_pairs(), 1, first_capacity_);
    if (rows > rows_.capacity()) rows_ = GrowableBuffer(device_, "body pairs", sizeof(BodyPair), rows);
}

void BodyPairs::upload(std::span<const BodyPair> pairs) {
    on_host_ = pairs;
    searches_ = complete_ = false;
    if (pairs.size() > rows_.capacity()) rows_.grow(pairs.size());
    const StageScope scope(device_, Stage::write);
    device_.upload(rows_.buffer(), std::as_bytes(pairs), 0, writes_ == Status::Writes::blocking);
}

void BodyPairs::upload_given(std::span<const BodyPair> given) {
    if (given.size() > GrowableBuffer::most)
        throw InputError(fmt::format("run() got {} body pairs; give at most 2^32 - 1", given.size()));
    upload(given);
}

void BodyPairs::begin_on_device(std::optional<std::span<const BodyPair>> given) {
    if (given) {
        upload_given(*given);
        return;
    }
    if (method_ == Broad::sphere_boxes)
        throw InputError("setting broad=sphere_boxes finds body pairs on the host and the frame is in device "
                         "memory; choose broad=device, or give body pairs");
    make_stage();
    on_host_ = {};
    searches_ = complete_ = true;
    if (!sorted_) stage_->sort_by_volumes();
    sorted_ = true;
}

void BodyPairs::begin(const FrameInput& input, std::optional<std::span<const BodyPair>> given) {
    if (given) {
        upload_given(*given);
    } else if (!broad_) {
        on_host_ = {};
        searches_ = complete_ = true;
        // Once a session, because bodies move little between frames. An old order costs time but no pairs.
        if (!sorted_) stage_->sort(input.frame);
        sorted_ = true;
    } else {
        {
            const HostWork work(device_, Stage::broad, "body pairs");
            found_ = broad_->pairs(input);
            std::erase_if(found_, [this](BodyPair pair) { return !contains(pair); });
            keep_part();
        }
        upload(found_);
        complete_ = method_ != Broad::sphere_boxes; // others find all whose volumes overlap
    }
}

/// Keeps the pairs that the settings ask for.
void BodyPairs::keep_part() {
    if (first_ == 0 && most_ == 0) return;
    found_.erase(found_.begin(),
                 found_.begin() + static_cast<std::ptrdiff_t>(std::min(first_, found_.size())));
    if (most_ != 0 && most_ < found_.size()) found_.resize(most_);
}

void BodyPairs::set_subdomain(const Subdomain& subdomain) {
    roles_ = roles_of(subdomain, scene_.bodies.size());
    if (stage_) stage_->set_subdomain(subdomain);
    sorted_ = true;
}

/// Whether the pair belongs to the subdomain.
bool BodyPairs::contains(BodyPair pair) const {
    if (roles_.empty()) return true;
    const auto a = roles_[pair.a], b = roles_[pair.b];
    return a != Role::none && b != Role::none && (a == Role::own || b == Role::own);
}

void BodyPairs::begin_part(std::span<const BodyPair> part) { upload(part); }

void BodyPairs::launch(const Status& status) {
    if (searches_) stage_->launch(rows_.buffer(), rows_.capacity(), status.buffer());
}

bool BodyPairs::grow(const Status& status) {
    const auto found = status.counter(STATUS_BODY_PAIRS);
    if (!searches_ || found <= rows_.capacity()) return false;
    rows_.grow(found);
    return true;
}

std::vector<BodyPair> BodyPairs::list(const FrameInput* input, const Status& status) const {
    if (!searches_) return {on_host_.begin(), on_host_.end()};
    const auto found = status.counter(STATUS_BODY_PAIRS);
    if (found > rows_.capacity()) {
        if (input == nullptr)
            throw OutOfMemory(fmt::format("{}: out of memory for {} body pairs; raise --memory, or use fewer "
                                          "bodies",
                                          device_.info().id, found));
        const HostWork work(device_, Stage::broad, "body pairs");
        auto all = BroadSweep(scene_, geometry_, Broad::tight, self_).pairs(*input);
        std::erase_if(all, [this](BodyPair pair) { return !contains(pair); });
        return all;
    }
    std::vector<BodyPair> pairs(found);
    {
        const StageScope scope(device_, Stage::read);
        device_.download(rows_.buffer(), std::as_writable_bytes(std::span(pairs)));
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

} // namespace tandem
