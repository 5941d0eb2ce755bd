// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/self_pairs.h"
#include "algorithms/parameters/table.h"
#include "algorithms/traversal.h"
#include "backends/registry.h"
#include "harness/verify/reference.h"
#include "base/random.h"
#include "tests/support/test.h"

#include <algorithm>
#include <set>
#include <sstream>

namespace tandem::support {

/// All devices, with guarded buffers: a frame fails if a kernel writes past the end of a buffer. The address
/// sanitizer detects this without guards.
inline std::vector<BackendReport> guarded_backends() {
    auto backends = discover();
#if !defined(__SANITIZE_ADDRESS__)
    for (const auto& backend : backends)
        for (const auto& found : backend.devices) found->guard_buffers();
#endif
    return backends;
}

inline Device& device(std::string_view id) {
    static const auto backends = guarded_backends();
    for (const auto& backend : backends)
        for (const auto& candidate : backend.devices)
            if (candidate->info().id == id) return *candidate;
    throw DeviceError("no device " + std::string(id));
}

/// Host and opencl:0, which the tests require, and every other available device. Found once: dozens of suites
/// ask, and opening a GPU takes most of a second.
inline const std::vector<std::string>& device_names() {
    static const auto all = [] {
        std::vector<std::string> names{"host", "opencl:0"};
        for (const auto& backend : discover())
            for (const auto& found : backend.devices)
                if (std::find(names.begin(), names.end(), found->info().id) == names.end())
                    names.push_back(found->info().id);
        return names;
    }();
    return all;
}

/// Label of a device in the name of a parameterized test.
inline std::string device_label(const std::string& device) {
    std::string name = device == "opencl:0" ? "opencl" : device;
    name.erase(std::remove(name.begin(), name.end(), ':'), name.end());
    name.front() = static_cast<char>(std::toupper(name.front()));
    return name;
}

inline bool declares(const Traversal& traversal, std::string_view setting) {
    const auto all = traversal.parameters();
    return std::any_of(all.begin(), all.end(), [&](const auto* p) { return p->name == setting; });
}

/// Settings written as "k=8 precision=double".
inline SettingTexts texts(const std::string& words) {
    SettingTexts result;
    std::istringstream in(words);
    for (std::string word; in >> word;) {
        const auto end = word.find('=');
        result[word.substr(0, end)] = word.substr(end + 1);
    }
    return result;
}

/// The settings over the defaults of the algorithm.
inline Settings resolved(const Traversal& traversal, const SettingTexts& given = {}) {
    return resolve(traversal.parameters(), {}, given, traversal.name());
}

/// A session on one device.
inline std::unique_ptr<Session> prepare_on(Device& on, const Traversal& traversal, const Scene& scene,
                                           const Settings& settings) {
    const std::array devices{&on};
    return traversal.prepare(devices, scene, settings);
}
inline std::unique_ptr<Session> prepare_on(Device& on, const Traversal& traversal, const Scene& scene,
                                           const SettingTexts& given = {}) {
    return prepare_on(on, traversal, scene, resolved(traversal, given));
}

/// Pairs and contacts of a result equal those of another, or of the reference.
inline void expect_same_digests(const FrameResult& result, const FrameResult& right) {
    EXPECT_EQ(result.digest(), right.digest());
    EXPECT_EQ(result.contact_digest(), right.contact_digest());
}
inline void expect_same_digests(const FrameResult& result, const ReferenceAnswer& right) {
    EXPECT_EQ(result.digest(), right.digest);
    EXPECT_EQ(result.contact_digest(), right.contact_digest);
}

/// Every data path of the algorithm.
inline std::vector<SettingTexts> residencies_of(const Traversal& traversal) {
    if (!declares(traversal, "residency")) return {{}};
    return {{{"residency", "resident"}}, {{"residency", "published"}}};
}

/// Values of one setting (or of several at once, written "k=8,axes=coordinate").
using Axis = std::vector<SettingTexts>;

/// Rows in which every pair of values of any two axes occurs at least once; greedy, with a fixed seed.
inline std::vector<SettingTexts> pairwise(const std::vector<Axis>& axes) {
    using Choice = std::pair<std::size_t, std::size_t>; // axis, value
    std::set<std::pair<Choice, Choice>> uncovered;
    for (std::size_t i = 0; i < axes.size(); ++i)
        for (std::size_t j = i + 1; j < axes.size(); ++j)
            for (std::size_t a = 0; a < axes[i].size(); ++a)
                for (std::size_t b = 0; b < axes[j].size(); ++b) uncovered.insert({{i, a}, {j, b}});
    Random random(7);
    std::vector<SettingTexts> rows;
    while (!uncovered.empty()) {
        std::vector<std::size_t> best;
        std::size_t most = 0;
        const auto covers = [&](const std::vector<std::size_t>& row) {
            return static_cast<std::size_t>(
                std::count_if(uncovered.begin(), uncovered.end(), [&](const auto& pair) {
                    return row[pair.first.first] == pair.first.second
                           && row[pair.second.first] == pair.second.second;
                }));
        };
        for (int attempt = 0; attempt < 100; ++attempt) {
            std::vector<std::size_t> row;
            for (const auto& axis : axes) row.push_back(random.next() % axis.size());
            row[uncovered.begin()->first.first] = uncovered.begin()->first.second;
            row[uncovered.begin()->second.first] = uncovered.begin()->second.second;
            if (const auto count = covers(row); count > most) {
                most = count;
                best = row;
            }
        }
        SettingTexts settings;
        for (std::size_t i = 0; i < axes.size(); ++i)
            settings.insert(axes[i][best[i]].begin(), axes[i][best[i]].end());
        rows.push_back(settings);
        std::erase_if(uncovered, [&](const auto& pair) {
            return best[pair.first.first] == pair.first.second
                   && best[pair.second.first] == pair.second.second;
        });
    }
    return rows;
}

/// All body pairs that may meet, with setting self. The traversal must not depend on the broad
/// phase.
inline std::vector<BodyPair> all_pairs(const Scene& scene, SelfPairs self = SelfPairs::off) {
    std::vector<BodyPair> pairs;
    for (std::uint32_t a = 0; a < scene.bodies.size(); ++a) {
        if (meets_itself(scene, a, self)) pairs.push_back({a, a});
        for (std::uint32_t b = a + 1; b < scene.bodies.size(); ++b)
            if (may_meet(scene, a, b)) pairs.push_back({a, b});
    }
    return pairs;
}

/// Runs a frame on all body pairs, or on those that the device finds if the broad phase runs there.
inline FrameResult run_among_all(Session& session, const Scene& scene, const Frame& frame) {
    if (session.settings()[parameters::broad] == Broad::device) return session.run(frame);
    return session.run(frame, all_pairs(scene, session.settings()[parameters::self]));
}

inline std::string text(const SettingTexts& settings) {
    std::string result;
    for (const auto& [name, value] : settings) result += " " + name + "=" + value;
    return result;
}

} // namespace tandem::support
