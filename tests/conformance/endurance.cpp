// SPDX-License-Identifier: MIT
// A session that runs for days: memory of the process does not grow from frame to frame.
#include "tests/support/cells.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

#include <unistd.h>

namespace tandem {
namespace {

using namespace support;

/// Resident bytes of the process.
std::int64_t resident_bytes() {
    std::int64_t size = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> size >> resident;
    return resident * sysconf(_SC_PAGESIZE);
}

/// Frames of bodies that collide and separate. As in a simulator, every result is used and dropped, and every
/// hundredth is kept for a while. The first tenth may fill caches; after that, memory may grow by at most one
/// page per thousand frames.
void expect_flat_memory(const std::string& on, std::size_t frames) {
    const auto scene = crowd(3, 5, 2.2); // a few pairs
    for (const auto* traversal : algorithms()) {
        SettingTexts given{{"pair_capacity", "4096"}, {"contact_capacity", "4096"}, {"work_items", "64"}};
        if (declares(*traversal, "queue_bytes")) given["queue_bytes"] = "65536";
        const auto session = prepare_on(device(on), *traversal, scene, given);
        const std::vector<Frame> poses{scene.frame(0), scene.frame(1)};
        FrameResult kept;
        std::uint64_t pairs = 0;
        std::int64_t before = 0;
        for (std::size_t i = 0; i < frames; ++i) {
            if (i == frames / 10) before = resident_bytes();
            auto result = session->run(poses[i % 2]);
            pairs += result.count;
            if (i % 100 == 0) kept = std::move(result);
        }
        EXPECT_GT(pairs, frames / 2) << traversal->name();
        EXPECT_EQ(kept.digest().count, kept.count) << traversal->name();
        EXPECT_LT(resident_bytes() - before, static_cast<std::int64_t>(frames) / 1000 * 4096 + (1 << 18))
            << traversal->name() << " on " << on;
    }
}

TEST(Endurance, ThousandsOfFramesLeaveMemoryFlat) { expect_flat_memory("host", 2500); }

/// On every device; fewer frames where each needs kernel launches.
TEST(Endurance, AHundredThousandFramesLeaveMemoryFlatOnlyLong) {
    for (const auto& on : device_names()) expect_flat_memory(on, on == "host" ? 100000 : 20000);
}

} // namespace
} // namespace tandem
