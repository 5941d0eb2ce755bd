// SPDX-License-Identifier: MIT
#include "algorithms/kdop_session.h"

#include "algorithms/sources.h"
#include "algorithms/status.clh"
#include "scenes/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

constexpr std::uint64_t pair_bytes = 16;
constexpr std::uint64_t word_limit = std::numeric_limits<std::uint32_t>::max();

const std::vector<Parameter> common{
    {"broad",
     "sphere",
     {"sphere", "tight", "device"},
     0,
     0,
     "who finds body pairs: the host by the paper's spheres, or by boxes, or the device by root k-DOPs"},
    {"body_pair_capacity", "65536", {}, 1, word_limit, "broad=device: body pairs there is room for at first"},
    {"residency",
     "resident",
     {"resident", "published"},
     0,
     0,
     "published: convert, upload and read back everything in every frame, as the paper's code"},
    {"output", "pairs", {"pairs", "count", "digest"}, 0, 0, "what a walk hands out; contacts need pairs"},
    {"group_size", "128", {}, 1, 1024, "work-items per work-group (1 on host)"},
    {"work_items", "2048", {}, 1, 1 << 20, "work-items per compute unit of the kernels that stride"},
    {"pair_capacity", "1048576", {}, 1, word_limit, "candidate pairs there is room for at first"},
    {"contact_capacity", "1048576", {}, 1, word_limit, "contacts there is room for at first"},
};

std::uint32_t group_size_of(const Settings& settings) {
    return static_cast<std::uint32_t>(integer(settings, "group_size"));
}

Output output_of(const Settings& settings) {
    const auto& name = settings.at("output");
    return name == "pairs" ? Output::pairs : name == "count" ? Output::count : Output::digest;
}

std::uint32_t groups_of(const Settings& settings, const DeviceInfo& info) {
    const auto items = static_cast<std::uint64_t>(integer(settings, "work_items")) * info.compute_units;
    return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, items / group_size_of(settings)));
}

/// Some room above what was needed: the next frame needs about as much.
std::uint64_t with_room(std::uint64_t count, std::string_view what) {
    if (count > word_limit)
        throw DeviceError(
            fmt::format("{} {} do not fit into one buffer of at most {}; use output=digest or fewer bodies",
                        count, what, word_limit));
    return std::min(count + count / 8, word_limit);
}

} // namespace

std::vector<Parameter> kdop_parameters(std::span<const Parameter> own) {
    const auto geometry = geometry_parameters();
    std::vector<Parameter> all(geometry.begin(), geometry.end());
    const auto contact = contact_parameters();
    all.insert(all.end(), contact.begin(), contact.end());
    all.insert(all.end(), common.begin(), common.end());
    all.insert(all.end(), own.begin(), own.end());
    return all;
}

Settings effective(Settings settings, const DeviceInfo& info) {
    const auto geometry = geometry_of(settings);
    if (geometry.rounding == Rounding::directed && !info.has_directed_rounding)
        throw InputError(
            fmt::format("setting rounding=directed is impossible on {}, which adds to nearest only; "
                        "choose safe, or a cuda device",
                        info.id));
    if (geometry.precision == Precision::twice && !info.has_double)
        throw InputError(fmt::format("setting precision=double is impossible on {}; choose float", info.id));
    if (contact_settings_of(settings).decision != DecisionPrecision::fp32 && !info.has_double)
        throw InputError(
            fmt::format("setting decision={} is impossible on {}, which has no double; choose fp32",
                        settings.at("decision"), info.id));
    const auto wanted = integer(settings, "group_size");
    if (info.max_group_size == 1)
        settings["group_size"] = "1";
    else if (wanted > info.max_group_size)
        throw InputError(fmt::format("setting group_size={} is impossible on {}; it takes at most {}", wanted,
                                     info.id, info.max_group_size));
    if (settings.at("broad") == "device" && settings.at("residency") == "published")
        throw InputError("setting broad=device does not go with residency=published, whose bounds are the "
                         "host's; choose broad=sphere");
    return settings;
}

KdopSession::KdopSession(Device& device, const Scene& scene, Settings settings, std::uint32_t leaves)
    : settings_(effective(std::move(settings), device.info())),
      device_(device),
      output_(output_of(settings_)),
      published_(settings_.at("residency") == "published"),
      scene_(device, scene, geometry_of(settings_), leaves, group_size_of(settings_),
             published_ ? Residency::published : Residency::resident),
      groups_(groups_of(settings_, device.info())) {
    status_ = device.allocate(STATUS_WORDS * 4, "status");
    reserve_pairs(output_ == Output::pairs ? static_cast<std::uint64_t>(integer(settings_, "pair_capacity"))
                                           : 1);
    digest_kernel_ = device.compile(kernel_source("algorithms/digest.cl"), "digest_pairs",
                                    row_defines(scene_.geometry(), scene_.group_size()));
    if (settings_.at("broad") == "device") {
        broad_ = std::make_unique<BroadStage>(scene_, scene, groups_);
        const auto first = static_cast<std::uint64_t>(integer(settings_, "body_pair_capacity"));
        reserve_body_pairs(std::clamp<std::uint64_t>(broad_->most_pairs(), 1, first));
    }
    if (output_ == Output::pairs && settings_.at("contact_rule") != "none")
        contact_stage_ = std::make_unique<ContactStage>(
            scene_, contact_settings_of(settings_),
            static_cast<std::uint64_t>(integer(settings_, "contact_capacity")), groups_);
}

Defines KdopSession::defines() const {
    auto defines = geometry_defines(scene_.geometry(), scene_.group_size());
    defines["LEAF_BITS"] = std::to_string(ceil_log2(scene_.leaves()));
    defines["OUTPUT"] = std::to_string(static_cast<int>(output_));
    defines["COUNT_WORK"] = counting_ ? "1" : "0";
    defines["BROAD_ON_DEVICE"] = finds_pairs() ? "1" : "0";
    return defines;
}

void KdopSession::count_work(bool on) {
    counting_ = on;
    do_compile(defines());
}

void KdopSession::reserve_pairs(std::uint64_t count) {
    capacity_ = count;
    found_ = {};
    found_ = device_.allocate(count * pair_bytes, "candidate pairs");
}

void KdopSession::reserve_body_pairs(std::uint64_t count) {
    pair_room_ = count;
    pairs_ = {};
    pairs_ = device_.allocate(count * sizeof(BodyPair), "body pairs");
}

void KdopSession::upload_pairs(std::span<const BodyPair> pairs) {
    if (!pairs_ || pairs.size() > pair_room_) reserve_body_pairs(pairs.size() + pairs.size() / 4);
    const StageScope scope(device_, Stage::write);
    device_.upload(pairs_, std::as_bytes(pairs), 0, published_);
}

void KdopSession::sort_bodies(const Frame& frame) {
    if (!sorted_) broad_->sort(frame);
    sorted_ = true;
}

void KdopSession::launch_frame(std::span<const BodyPair> pairs) {
    if (broad_) broad_->launch(pairs_, pair_count(pairs), status_);
    if (pairs.empty() && !broad_) return;
    do_walk(pairs);
    if (makes_contacts() && !published_ && !counting_) contact_stage_->launch(found_, 0, capacity_, status_);
}

FrameResult KdopSession::run(const Frame& frame, std::span<const BodyPair> pairs) {
    if (broad_ && !pairs.empty())
        throw InputError("run() was given body pairs, which setting broad=device finds; give none");
    if (pairs.size() > word_limit)
        throw InputError(
            fmt::format("run() was given {} body pairs; kernels number at most 2^32 - 1", pairs.size()));
    scene_.update(frame);
    if (broad_)
        sort_bodies(frame);
    else
        upload_pairs(pairs);
    for (std::uint64_t retries = 0;; ++retries) {
        clear_status();
        contacts_read_ = 0;
        launch_frame(pairs);
        const auto status = read_status();
        if (grow(status)) continue;
        auto result = result_of(status);
        result.body_pairs = broad_ ? status.counter(STATUS_BODY_PAIRS) : pairs.size();
        result.retries = retries;
        if (published_) sort_contacts(result.contacts);
        return result;
    }
}

Status KdopSession::read_status() {
    const StageScope scope(device_, Stage::read);
    device_.download(status_, std::as_writable_bytes(std::span(status_words_)));
    return Status(status_words_);
}

void KdopSession::clear_status() {
    status_words_.assign(STATUS_WORDS, 0);
    device_.clear(status_, STATUS_WORDS * 4);
}

void KdopSession::set_status(std::size_t word, std::uint64_t value) {
    status_words_[word] = static_cast<std::uint32_t>(value);
    status_words_[word + 1] = static_cast<std::uint32_t>(value >> 32);
    // Written whole: Oclgrind 21.10 takes the rest of a buffer for uninitialised after a partial write.
    const StageScope scope(device_, Stage::write);
    device_.upload(status_, bytes_of(status_words_), 0, published_);
}

bool KdopSession::grow(const Status& status) {
    bool again = do_grow(status);
    const auto body_pairs = status.counter(STATUS_BODY_PAIRS);
    if (broad_ && body_pairs > pair_room_) {
        reserve_body_pairs(with_room(body_pairs, "body pairs"));
        again = true;
    }
    const auto found = status.counter(STATUS_PAIRS);
    if (output_ == Output::pairs && found > capacity_) {
        reserve_pairs(with_room(found, "candidate pairs"));
        again = true;
    }
    const auto contacts = status.counter(STATUS_CONTACTS);
    if (contact_stage_ && contacts > contact_stage_->capacity()) {
        contact_stage_->reserve(with_room(contacts, "contacts"));
        again = true;
    }
    return again;
}

FrameResult KdopSession::result_of(const Status& status) const {
    FrameResult result;
    result.count = status.counter(STATUS_PAIRS);
    result.contacts = status.counter(STATUS_CONTACTS);
    result.degenerate = status.counter(STATUS_DEGENERATE);
    result.rejected = status.counter(STATUS_REJECTED);
    result.unsure = status.counter(STATUS_UNSURE);
    result.uncertain = status.counter(STATUS_UNCERTAIN);
    if (output_ == Output::pairs) {
        result.pairs = found_;
        result.capacity = capacity_;
    }
    if (output_ == Output::digest)
        result.digest =
            Digest{result.count, status.counter(STATUS_DIGEST_A), status.counter(STATUS_DIGEST_B)};
    if (counting_) {
        result.work.bvtt_nodes = status.counter(STATUS_BVTT_NODES);
        result.work.seeds = status.counter(STATUS_SEEDS);
        result.work.refills = status.counter(STATUS_REFILLS);
        result.work.spills = status.counter(STATUS_SPILLS);
        do_report(result.work);
    }
    return result;
}

std::uint64_t KdopSession::publish_contacts(std::uint64_t first) {
    const auto found = read_status().counter(STATUS_PAIRS);
    if (found <= first || !makes_contacts() || counting_) return found;
    contact_stage_->launch(found_, first, capacity_, status_);
    const auto contacts = std::min(read_status().counter(STATUS_CONTACTS), contact_stage_->capacity());
    if (contacts > contacts_read_) {
        const StageScope scope(device_, Stage::read);
        const auto row = 8 * real_bytes(scene_.geometry());
        std::vector<std::byte> values((contacts - contacts_read_) * row);
        std::vector<std::byte> ids((contacts - contacts_read_) * 8);
        device_.download(contact_stage_->values(), values, contacts_read_ * row);
        device_.download(contact_stage_->ids(), ids, contacts_read_ * 8);
        contacts_read_ = contacts;
    }
    return found;
}

Digest KdopSession::digest(const FrameResult& result) {
    if (result.digest) return *result.digest;
    const StageScope scope(device_, Stage::postprocess);
    set_status(STATUS_DIGEST_A, 0);
    set_status(STATUS_DIGEST_B, 0);
    const std::array<Argument, 5> arguments{found_, static_cast<std::uint32_t>(capacity_), scene_.bodies(),
                                            scene_.tetrahedron_ids(), status_};
    device_.launch(digest_kernel_, {groups_, scene_.group_size()}, arguments);
    const auto status = read_status();
    return {result.count, status.counter(STATUS_DIGEST_A), status.counter(STATUS_DIGEST_B)};
}

Digest KdopSession::contact_digest(const FrameResult& result) {
    if (!contact_stage_) return {};
    const StageScope scope(device_, Stage::postprocess);
    set_status(STATUS_CONTACT_DIGEST_A, 0);
    set_status(STATUS_CONTACT_DIGEST_B, 0);
    contact_stage_->launch_digest(found_, status_);
    const auto status = read_status();
    return {result.contacts, status.counter(STATUS_CONTACT_DIGEST_A),
            status.counter(STATUS_CONTACT_DIGEST_B)};
}

} // namespace tandem
