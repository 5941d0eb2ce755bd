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
    std::uint64_t count = 0, ///< elements
        a = 0,               ///< sum of a 64-bit term of each element, modulo 2^64
        b = 0;               ///< the same of another term

    /// Adds the digest of a disjoint set; the result is the digest of the union.
    Digest& operator+=(const Digest& other);
    /// Equal sets have equal digests. Different sets may have equal digests, which is improbable.
    bool operator==(const Digest&) const = default;
};

/// Candidate pairs in a device's memory (answer/pairs.clh). PairLayout::slots has rows of 2 words, the slots
/// of the two tetrahedra. PairLayout::items has rows of 4 words: body a, body b, and the positions of the
/// tetrahedra in the orders of their bodies.
struct PairBuffer {
    Buffer rows;                           ///< empty when the pairs are not on a device
    PairLayout layout = PairLayout::slots; ///< format of a row
    std::uint64_t count = 0;               ///< pairs, one a row
    std::uint64_t capacity = 0;            ///< in rows
};

/// The part of a frame's answer from one device, in the memory of the device or of the host.
class AnswerPart {
public:
    virtual ~AnswerPart() = default;

    /// The pairs in the device's memory. Digests of pairs and contacts use ids in input order, so that they
    /// do not depend on the device.
    virtual PairBuffer pairs() const = 0;
    /// Enqueues writing pairs first..first + count - 1 to a buffer of the device: rows of 4 words, body a,
    /// tetrahedron a, body b, tetrahedron b, with the scene's numbers. Throws DeviceError for pairs that are
    /// not on a device.
    virtual void expand(std::uint64_t first, std::uint64_t count, const Buffer& expanded) const = 0;
    /// expand() of all pairs in canonical order, whatever setting order is. Waits. Throws also OutOfMemory:
    /// it takes the bytes of the rows, 8 more for each pair, and 8 to 12 for each tetrahedron of the bodies.
    virtual void expand_sorted(const Buffer& expanded) const = 0;
    /// Digest of its pairs. Computes it where the pairs are, and waits.
    virtual Digest digest() const = 0;
    /// Digest of its contacts, of their pairs, features and values. Computes it where they are, and waits.
    virtual Digest contact_digest() const = 0;
    /// Appends its pairs, in any order.
    virtual void append_pairs(std::vector<Pair>& pairs) const = 0;
    /// Appends its contacts, in any order. Their points are relative to FrameResult::origin.
    virtual void append_contacts(std::vector<ContactPoint>& contacts) const = 0;
    /// Adds for each body the number of pairs that contain it.
    virtual void count_by_body(std::vector<std::uint64_t>& counts) const = 0;
};

/// The work of one of several devices in a frame.
struct DeviceWork {
    std::uint64_t bodies = 0;         ///< placed and bounded: own bodies and ghosts
    std::uint64_t body_pairs = 0;     ///< walked
    std::uint64_t pairs = 0;          ///< candidate pairs found
    std::int64_t ns = 0;              ///< from the start of its work to its answer, by the host's clock
    std::int64_t exchange_ns = 0;     ///< before `ns`, on ranks of a job: messages, and waits for them
    std::uint64_t exchange_bytes = 0; ///< sent
    std::uint64_t messages = 0;       ///< sent
};

/// The counts of a frame: ON_DEVICE(member, its counter in kernels/status.clh), or ON_HOST(member).
// clang-format off
#define TANDEM_FRAME_COUNTS(ON_DEVICE, ON_HOST) \
    /** candidate pairs */ ON_DEVICE(count, STATUS_PAIRS) \
    /** passed to run(), or found */ ON_DEVICE(body_pairs, STATUS_BODY_PAIRS) \
    /** contact points; 0 unless output=pairs */ ON_DEVICE(contacts, STATUS_CONTACTS) \
    /** pairs without the boundary faces that the contact rule needs */ ON_DEVICE(without_boundary, STATUS_WITHOUT_BOUNDARY) \
    /** pairs without contacts because the sign of a tetrahedron's volume is not certain */ ON_DEVICE(degenerate, STATUS_DEGENERATE) \
    /** pairs with a separating axis */ ON_DEVICE(rejected, STATUS_REJECTED) \
    /** by the certified filter (decision=recheck, exact) */ ON_DEVICE(undecided_by_filter, STATUS_UNDECIDED_BY_FILTER) \
    /** by double precision (decision=recheck, fp64, exact) */ ON_DEVICE(undecided_by_double, STATUS_UNDECIDED_BY_DOUBLE) \
    /** trees built because none was kept (leaf_query, tree=scene) */ ON_DEVICE(rebuilds, STATUS_REBUILDS) \
    /** repetitions of a walk because a buffer was too small */ ON_HOST(retries) \
    /** number of batches; 1: the frame fitted into memory */ ON_HOST(batches)
// clang-format on

/// Counts of a frame, which are summed over devices, ranks and batches: the rows of TANDEM_FRAME_COUNTS.
struct FrameCounts {
#define TANDEM_MEMBER(member, ...) std::uint64_t member = 0;
    TANDEM_FRAME_COUNTS(TANDEM_MEMBER, TANDEM_MEMBER)
#undef TANDEM_MEMBER

    /// Adds every count of `other`.
    FrameCounts& operator+=(const FrameCounts& other);
};

/// The answer of a frame. It owns its parts: one for each device, and one for each batch, whose pairs are in
/// the host's memory. It is valid as long as its scene and devices exist, also after the next run: the
/// session does not reuse its buffers before it is destroyed.
struct FrameResult : FrameCounts {
    std::vector<DeviceWork> shared;                 ///< by device; empty for a session on one device
    std::uint64_t repartitions = 0;                 ///< 1: the bodies were repartitioned in this frame
    std::map<std::string_view, std::uint64_t> work; ///< by Counter; empty unless Session::count_work(true)
    std::optional<Digest> summed;                   ///< digest of the pairs with output=digest
    std::array<double, 3> origin{};                 ///< of contact points in the parts (Session::origin)
    bool has_points = true; ///< whether contacts are points: false with output=wrenches
    std::vector<std::shared_ptr<const AnswerPart>> parts; ///< empty unless output=pairs

    /// False with output=count or output=digest, which store no pairs.
    bool has_pairs() const { return !parts.empty(); }
    /// Adds the counts of another device, rank or batch, and its digest with output=digest.
    void add(const FrameCounts& counts, const std::optional<Digest>& digest);
    /// Contacts per candidate pair; 1 without candidate pairs.
    double contacts_a_pair() const;
    /// Digest of the pairs, computed in the memory where they are. Not part of a measured frame. The sums are
    /// 0 with output=count.
    Digest digest() const;
    /// Digest of the contacts, computed in the memory where they are. Not part of a measured frame. All zero
    /// unless output=pairs.
    Digest contact_digest() const;
    /// Sorted pairs; empty unless output=pairs.
    std::vector<Pair> download() const;
    /// Contacts in world coordinates, sorted by pair and feature; empty unless output=pairs. With
    /// output=wrenches a row for each body pair: `point` is the force on body a, `normal` the torque about
    /// its pose, `depth` the area, `feature` the number of polygons.
    std::vector<ContactPoint> download_contacts() const;
};

} // namespace tandem
