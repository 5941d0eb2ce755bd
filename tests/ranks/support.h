// SPDX-License-Identifier: MIT
// Sessions on the ranks of a job, beside the same on one device.
#pragma once

#include "algorithms/distributed/bytes.h"
#include "algorithms/distributed/rank_session.h"
#include "tests/ranks/job.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {

using namespace support;

/// The rank's own device: host, or a GPU each if TANDEM_TEST_RANKS_ON is cuda.
inline Device& own_device() {
    const auto* on = std::getenv("TANDEM_TEST_RANKS_ON");
    return device(on == nullptr ? "host" : fmt::format("{}:{}", on, job->rank()));
}

inline Settings settings_of(const Traversal& traversal, const SettingTexts& given = {}) {
    return resolve(traversal.parameters(), traversal.presets().front().values, given, traversal.name());
}

/// Sum over all ranks.
template<class T>
T summed(const T& own) {
    T sum{};
    const auto all = job->gather_to_all(std::as_bytes(std::span(&own, 1)));
    for (const auto& bytes : all) sum += MessageReader(bytes).read<T>();
    return sum;
}

/// The part of a frame that a rank has to provide. All other bodies are moved far away, so using them by
/// mistake changes the answer.
inline Frame own_frame(const Scene& scene, const Session& session, std::size_t number) {
    auto frame = scene.frame(number);
    std::vector<bool> is_own(scene.bodies.size());
    const auto own = session.owned().value();
    for (const auto body : own) is_own[body] = true;
    for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
        if (is_own[body] || scene.bodies[body].fixed) continue;
        frame.poses[body].translation = {1e6, 0, 0};
        frame.deformed[body].clear();
        if (!frame.skipped.empty()) frame.skipped[body].clear();
    }
    return frame;
}

/// A procession in which all bodies except the fixed one and every fifth are deformable.
inline Scene soft_procession(std::uint32_t bodies, std::size_t frames, double step) {
    auto scene = procession(bodies, frames, step);
    const auto vertices = scene.meshes.front().vertices;
    for (std::uint32_t body = 1; body < bodies; ++body) scene.bodies[body].deformable = body % 5 != 0;
    scene.frame = [whole = scene.frame, vertices](std::size_t number) {
        auto frame = whole(number);
        for (std::uint32_t body = 2; body < frame.poses.size(); ++body) {
            if (body % 5 == 0) continue;
            const auto pose = std::exchange(frame.poses[body], {});
            for (const auto& vertex : vertices)
                frame.deformed[body].push_back(pose.rotation * vertex + pose.translation);
        }
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// The scene, whose even frames skip the tetrahedra skipped(body, frame) of each body.
template<class Skipped>
Scene skipping(Scene scene, const Skipped& skipped) {
    scene.frame = [whole = scene.frame, skipped](std::size_t number) {
        auto frame = whole(number);
        if (number % 2 == 1) return frame;
        for (std::uint32_t body = 0; body < frame.poses.size(); ++body)
            frame.skipped.push_back(skipped(body, static_cast<std::uint32_t>(number)));
        return frame;
    };
    return scene;
}

class RankSessions : public testing::Test {
protected:
    /// Compares a frame run by all ranks with one that this rank runs alone on another session. Sessions with
    /// motion=linear get the next frame too.
    void expect_equal(const Scene& scene, Session& session, Session& alone, std::size_t number) {
        const bool moves = session.settings()[parameters::motion] == Motion::linear;
        const auto own = own_frame(scene, session, number), whole = scene.frame(number);
        const auto own_next = moves ? own_frame(scene, session, number + 1) : Frame{};
        const auto whole_next = moves ? scene.frame(number + 1) : Frame{};
        const auto result = session.run(FrameInput(own, moves ? &own_next : nullptr));
        const auto right = alone.run(FrameInput(whole, moves ? &whole_next : nullptr));
        ASSERT_GT(right.count, 0u);
        EXPECT_EQ(summed(result.count), right.count);
        EXPECT_EQ(summed(result.body_pairs), right.body_pairs);
        EXPECT_EQ(summed(result.contacts), right.contacts);
        EXPECT_EQ(summed(result.digest()), right.digest());
        EXPECT_EQ(summed(result.contact_digest()), right.contact_digest());
        ASSERT_EQ(result.shared.size(), static_cast<std::size_t>(job->size()));
        std::uint64_t pairs = 0;
        for (const auto& work : result.shared) pairs += work.pairs;
        EXPECT_EQ(pairs, right.count);
        EXPECT_EQ(result.shared[static_cast<std::size_t>(job->rank())].pairs, result.count);
        last_ = result;
    }
    /// Runs frames 0, 1 and 0 again.
    void expect_frames_equal(const Scene& scene, const Traversal& traversal, Device& on,
                             const SettingTexts& given = {}) {
        const auto session = traversal.prepare(on, scene, settings_of(traversal, given), *job);
        const auto one = alone(traversal, scene, given);
        for (const std::size_t i : {0u, 1u, 0u}) expect_equal(scene, *session, *one, i);
    }
    std::unique_ptr<Session> alone(const Traversal& traversal, const Scene& scene,
                                   const SettingTexts& given = {}) {
        const std::array one{&device("host")};
        return traversal.prepare(one, scene, settings_of(traversal, given));
    }

    FrameResult last_;
};

} // namespace tandem
