// SPDX-License-Identifier: MIT
#pragma once

#include "tests/support/cells.h"

namespace tandem::support {

/// Limits a device's memory to what is allocated plus `more` bytes, for the lifetime of the object.
class Limited {
public:
    Limited(Device& device, std::size_t more) : device_(device) {
        device.set_memory_limit(device.bytes_allocated() + more);
    }
    ~Limited() { device_.set_memory_limit(Device::no_memory_limit); }
    Limited(const Limited&) = delete;
    Limited& operator=(const Limited&) = delete;

private:
    Device& device_;
};

/// Bytes that a session needs when every capacity is minimal.
inline std::size_t least_bytes(Device& on, const Traversal& traversal, const Scene& scene,
                               SettingTexts given) {
    for (const auto* parameter : traversal.parameters())
        if (parameter->name.ends_with("_capacity")) given[std::string(parameter->name)] = "1";
    if (traversal.name() == "gproximity") given["queue_bytes"] = "65536";
    const auto before = on.bytes_allocated();
    const auto session = prepare_on(on, traversal, scene, given);
    return on.bytes_allocated() - before;
}

/// The parts of a frame's answer that must not depend on memory.
struct Answer {
    Digest pairs, contacts;
    std::map<std::string, std::uint64_t> counts; ///< that devices made

    explicit Answer(const FrameResult& result) : pairs(result.digest()), contacts(result.contact_digest()) {
#define TANDEM_COUNT(member, word) counts[#member] = result.member;
#define TANDEM_NONE(member)
        TANDEM_FRAME_COUNTS(TANDEM_COUNT, TANDEM_NONE)
#undef TANDEM_COUNT
#undef TANDEM_NONE
        counts.erase("rebuilds"); // a batch starts with another tree, and every device has its own
    }
    bool operator==(const Answer&) const = default;
};

} // namespace tandem::support
