// SPDX-License-Identifier: MIT
// Frames that a caller ends at a launch: no later launch begins, and the next frame has its answer.
#include "tests/support/on_device.h"
#include "tests/support/limited.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

/// Not derived from std::exception, so that nothing takes it for an error.
struct Ended {};

class EarlyEnds : public OnDevice {
protected:
    /// Runs a frame that ends at launch number `last`, or as a whole if it has fewer. Returns its launches.
    std::size_t run_until(Session& session, const Frame& frame, std::size_t last) {
        std::size_t launches = 0;
        on.set_check([&] {
            if (++launches == last) throw Ended{};
        });
        try {
            session.run(frame);
            EXPECT_LT(launches, last);
        } catch (const Ended&) {
            EXPECT_EQ(launches, last);
        }
        on.set_check({});
        on.finish();
        return launches;
    }
    void end_everywhere(const Traversal& traversal, const SettingTexts& given);

    const Scene scene = crowd(3, 5, 0.9);
};

void EarlyEnds::end_everywhere(const Traversal& traversal, const SettingTexts& given) {
    SCOPED_TRACE(fmt::format("{} {}", traversal.name(), text(given)));
    const auto session = prepare_on(on, traversal, scene, given);
    const auto frame = scene.frame(0);
    const auto right = session->run(frame);
    ASSERT_GT(right.count, 0u);
    constexpr std::size_t all = 10000;
    const auto launches = run_until(*session, frame, all);
    EXPECT_GE(launches, 3u);
    for (std::size_t last = 1; last <= launches; ++last) {
        run_until(*session, frame, last);
        const auto result = session->run(frame);
        EXPECT_EQ(result.digest(), right.digest()) << "after an end at launch " << last;
        EXPECT_EQ(result.contact_digest(), right.contact_digest());
    }
}

TEST_P(EarlyEnds, LeaveEverySessionUsable) {
    for (const auto* traversal : walks())
        for (const auto& residency : residencies_of(*traversal)) end_everywhere(*traversal, residency);
}

/// A first frame, whose buffers are too small, so that walks run again.
TEST_P(EarlyEnds, LeaveAFirstFrameToTheNext) {
    const SettingTexts smallest{
        {"pair_capacity", "1"}, {"contact_capacity", "1"}, {"body_pair_capacity", "1"}};
    const auto right = reference(scene, scene.frame(0), {}, true, Method::brute_force);
    for (const std::size_t last : {1u, 5u, 12u, 30u}) {
        const auto session = prepare_on(on, algorithm("tiled"), scene, smallest);
        run_until(*session, scene.frame(0), last);
        const auto result = session->run(scene.frame(0));
        expect_same_digests(result, right);
    }
}

TANDEM_ON_DEVICES(EarlyEnds);

} // namespace
} // namespace tandem
