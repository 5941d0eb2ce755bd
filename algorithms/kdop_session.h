// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/broad/broad_stage.h"
#include "algorithms/contacts/contact_stage.h"
#include "algorithms/traversal.h"

#include <array>

namespace tandem {

/// Parameters of every algorithm that walks k-DOP hierarchies, geometry included; `own` are appended.
std::vector<Parameter> kdop_parameters(std::span<const Parameter> own);

/// The settings as a device takes them: groups have one work-item where it knows no larger ones. Throws
/// InputError for what it cannot do.
Settings effective(Settings settings, const DeviceInfo& info);

enum class Output { pairs, count, digest };

/// The words of status.clh after a frame.
class Status {
public:
    explicit Status(std::span<const std::uint32_t> words) : words_(words.begin(), words.end()) {}
    /// The 64-bit counter whose low word is number `word`.
    std::uint64_t counter(std::size_t word) const {
        return words_[word] | std::uint64_t{words_[word + 1]} << 32;
    }

private:
    std::vector<std::uint32_t> words_;
};

/// A scene on a device, its pair and contact buffers, and the protocol of overflow: count on, grow, run
/// again. A derived class walks.
class KdopSession : public Session {
public:
    void reset() override { sorted_ = false; }
    bool finds_pairs() const final { return broad_ != nullptr; }
    FrameResult run(const Frame& frame, std::span<const BodyPair> pairs) final;
    Digest digest(const FrameResult& result) final;
    Digest contact_digest(const FrameResult& result) final;
    std::vector<Pair> download(const FrameResult& result) final;
    std::vector<ContactPoint> download_contacts(const FrameResult& result) final;
    void count_work(bool on) final;
    Device& device() final { return device_; }
    const Settings& settings() const final { return settings_; }

protected:
    KdopSession(Device& device, const Scene& scene, Settings settings, std::uint32_t leaves);

    /// Enqueues (or runs) the walk over body pairs that lie on the device in pairs(). `given` is empty when
    /// the device has found them.
    virtual void do_walk(std::span<const BodyPair> given) = 0;
    /// Grows own buffers that `status` shows too small; true when the walk has to run again.
    virtual bool do_grow(const Status&) { return false; }
    /// Compiles the walking kernels with defines() and COUNT_WORK as given.
    virtual void do_compile(const Defines& defines) = 0;
    virtual void do_report(Work&) const {}

    /// Contacts of the pairs from number `first` on, as the published schedules make them: counter and
    /// contacts are read back at once. Returns the pairs found so far.
    std::uint64_t publish_contacts(std::uint64_t first);
    Status read_status();
    /// Clears the status; its words are those of status.clh.
    void clear_status();
    /// Sets the 64-bit counter at `word`, with all others as they were last read or cleared.
    void set_status(std::size_t word, std::uint64_t value);

    const DeviceScene& scene() const { return scene_; }
    const Buffer& pairs() const { return pairs_; }
    /// What kernels call `pairs` in body_pairs.clh: how many were given, or how many there is room for.
    std::uint32_t pair_count(std::span<const BodyPair> given) const {
        return static_cast<std::uint32_t>(broad_ ? pair_room_ : given.size());
    }
    const Buffer& status() const { return status_; }
    const Buffer& found() const { return found_; }
    std::uint64_t capacity() const { return capacity_; }
    std::uint32_t groups() const { return groups_; }
    bool published() const { return published_; }
    Defines defines() const;

private:
    void reserve_body_pairs(std::uint64_t count);
    void upload_pairs(std::span<const BodyPair> pairs);
    void sort_bodies(const Frame& frame);
    void launch_frame(std::span<const BodyPair> pairs);
    bool grow(const Status& status);
    void reserve_pairs(std::uint64_t count);
    void sort_contacts(std::uint64_t count);
    bool makes_contacts() const { return contact_stage_ != nullptr; }
    FrameResult result_of(const Status& status) const;

    Settings settings_;
    Device& device_;
    Output output_;
    bool published_;
    DeviceScene scene_;
    std::uint32_t groups_;
    std::uint64_t capacity_ = 0;
    std::uint64_t pair_room_ = 0;
    std::uint64_t contacts_read_ = 0;
    bool counting_ = false;
    bool sorted_ = false;                     ///< the broad phase has the bodies in the order of some frame
    std::vector<std::uint32_t> status_words_; ///< as last read, cleared or set
    Buffer pairs_, status_, found_;
    Kernel digest_kernel_;
    std::unique_ptr<BroadStage> broad_; ///< none when the host finds body pairs
    std::unique_ptr<ContactStage> contact_stage_;
};

} // namespace tandem
