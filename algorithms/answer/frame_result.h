// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "backends/device.h"
#include "scenes/contact.h"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace tandem {

/// Order-free digest of a set: its 64-bit count and two wrapping sums of a fixed mix of its elements.
struct Digest {
    std::uint64_t count = 0, a = 0, b = 0;

    Digest& operator+=(const Digest& other);
    bool operator==(const Digest&) const = default;
};

/// Candidate pairs in a device's memory (answer/pairs.clh). With PairLayout::slots rows of 2 words, the slots
/// of the two tetrahedra; with items of 4: body a, body b, and the positions of the tetrahedra in their
/// bodies' orders.
struct PairBuffer {
    Buffer rows; ///< empty when the pairs are not on a device
    PairLayout layout = PairLayout::slots;
    std::uint64_t count = 0;
    std::uint64_t capacity = 0; ///< rows there is room for
};

/// What one device found of a frame, in its memory or brought to the host's.
class AnswerPart {
public:
    virtual ~AnswerPart() = default;

    /// The pairs where they are. Digests are of these and of the contacts, in input order's numbers, so that
    /// they do not depend on the device.
    virtual PairBuffer pairs() const = 0;
    /// Writes pairs first..first + count - 1 to a buffer of the device: rows of 4 words, body a, tetrahedron
    /// a, body b, tetrahedron b, as the scene numbers them. Enqueued; for pairs on a device.
    virtual void expand(std::uint64_t first, std::uint64_t count, const Buffer& expanded) const = 0;
    virtual Digest digest() const = 0;
    virtual Digest contact_digest() const = 0;
    /// Appends pairs and contacts, in no order.
    virtual void append_pairs(std::vector<Pair>& pairs) const = 0;
    virtual void append_contacts(std::vector<ContactPoint>& contacts) const = 0;
    /// Adds the number of pairs that each body is in, by body.
    virtual void count_by_body(std::vector<std::uint64_t>& counts) const = 0;
};

/// What one of several devices did of a frame.
struct DeviceWork {
    std::uint64_t bodies = 0;     ///< placed and bounded, whoever owns them
    std::uint64_t body_pairs = 0; ///< walked
    std::uint64_t pairs = 0;      ///< candidate pairs found
    std::int64_t ns = 0;          ///< from when it was given its share to its answer, by the host's clock
    std::int64_t exchange_ns = 0; ///< before that, on ranks of a job: passing messages, and waiting for them
    std::uint64_t exchange_bytes = 0; ///< sent
    std::uint64_t messages = 0;       ///< sent
};

/// What of a frame is counted, and adds up over devices, ranks and batches.
struct FrameCounts {
    std::uint64_t count = 0;      ///< candidate pairs
    std::uint64_t body_pairs = 0; ///< those given, or found
    std::uint64_t contacts = 0;
    std::uint64_t degenerate = 0;          ///< pairs without contacts because a tetrahedron has no volume
    std::uint64_t rejected = 0;            ///< pairs that were told apart
    std::uint64_t undecided_by_filter = 0; ///< that the certified filter left (decision=recheck, exact)
    std::uint64_t undecided_by_double = 0; ///< that double left (decision=recheck, fp64, exact)
    std::uint64_t retries = 0;             ///< times a buffer was too small and a walk ran again
    std::uint64_t batches = 0; ///< parts that the frame was split into for want of memory; 1: none

    FrameCounts& operator+=(const FrameCounts& other);
};

/// A frame's answer, which owns its parts: one for each device, and one for each batch whose pairs were
/// brought to the host to make room. It can be asked as long as its scene and devices live, also after the
/// next run; a session keeps its buffers apart until then.
struct FrameResult : FrameCounts {
    std::vector<DeviceWork> shared;                 ///< by device; of a session on one device none
    std::uint64_t repartitions = 0;                 ///< 1 where the bodies were dealt to the devices anew
    std::map<std::string_view, std::uint64_t> work; ///< by Counter; empty unless Session::count_work(true)
    std::optional<Digest> summed;                   ///< output=digest: of the pairs
    std::array<double, 3> origin{}; ///< what points of contacts in the parts count from (Session::origin)
    std::vector<std::shared_ptr<const AnswerPart>> parts; ///< none unless output=pairs

    /// False with output=count or digest, which keep none.
    bool has_pairs() const { return !parts.empty(); }
    /// Adds counts, and the sums of output=digest, of another device, rank or batch.
    void add(const FrameCounts& counts, const std::optional<Digest>& digest);
    /// 1 where there are no candidate pairs.
    double contacts_a_pair() const;
    /// Of pairs and contacts, summed where they are. Not part of a measured frame. Of an answer that only
    /// counts the sums are 0.
    Digest digest() const;
    Digest contact_digest() const;
    /// Pairs and contacts in the world, sorted; none unless output=pairs.
    std::vector<Pair> download() const;
    std::vector<ContactPoint> download_contacts() const;
};

} // namespace tandem
