// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/table.h"
#include "algorithms/traversal.h"
#include "backends/registry.h"
#include "harness/verify/reference.h"
#include "base/random.h"

#include <algorithm>
#include <set>

namespace tandem::testing_support {

/// All devices, with guarded buffers: a session's frame fails where a kernel has written past the end of one.
/// The address sanitizer sees that by itself, and more of it.
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

/// Host and opencl:0, without which the tests fail, and every other device there is.
inline std::vector<std::string> device_names() {
    std::vector<std::string> names{"host", "opencl:0"};
    for (const auto& backend : discover())
        for (const auto& found : backend.devices)
            if (std::find(names.begin(), names.end(), found->info().id) == names.end())
                names.push_back(found->info().id);
    return names;
}

/// What a test over device_names() calls one of them.
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

/// Every data path that the algorithm has.
inline std::vector<SettingTexts> residencies_of(const Traversal& traversal) {
    if (!declares(traversal, "residency")) return {{}};
    return {{{"residency", "resident"}}, {{"residency", "published"}}};
}

/// Values of one setting (or of several at once, written "k=8,axes=coordinate").
using Axis = std::vector<SettingTexts>;

/// Rows such that every pair of values of any two axes stands together in at least one of them; greedy, fixed
/// seed.
inline std::vector<SettingTexts> pairwise(const std::vector<Axis>& axes) {
    using Choice = std::pair<std::size_t, std::size_t>; // axis, value
    std::set<std::pair<Choice, Choice>> open;
    for (std::size_t i = 0; i < axes.size(); ++i)
        for (std::size_t j = i + 1; j < axes.size(); ++j)
            for (std::size_t a = 0; a < axes[i].size(); ++a)
                for (std::size_t b = 0; b < axes[j].size(); ++b) open.insert({{i, a}, {j, b}});
    Random random(7);
    std::vector<SettingTexts> rows;
    while (!open.empty()) {
        std::vector<std::size_t> best;
        std::size_t most = 0;
        const auto covers = [&](const std::vector<std::size_t>& row) {
            return static_cast<std::size_t>(std::count_if(open.begin(), open.end(), [&](const auto& pair) {
                return row[pair.first.first] == pair.first.second
                       && row[pair.second.first] == pair.second.second;
            }));
        };
        for (int attempt = 0; attempt < 100; ++attempt) {
            std::vector<std::size_t> row;
            for (const auto& axis : axes) row.push_back(random.next() % axis.size());
            row[open.begin()->first.first] = open.begin()->first.second;
            row[open.begin()->second.first] = open.begin()->second.second;
            if (const auto count = covers(row); count > most) {
                most = count;
                best = row;
            }
        }
        SettingTexts settings;
        for (std::size_t i = 0; i < axes.size(); ++i)
            settings.insert(axes[i][best[i]].begin(), axes[i][best[i]].end());
        rows.push_back(settings);
        std::erase_if(open, [&](const auto& pair) {
            return best[pair.first.first] == pair.first.second
                   && best[pair.second.first] == pair.second.second;
        });
    }
    return rows;
}

/// All body pairs but fixed-fixed ones: the traversal must not need the broad phase.
inline std::vector<BodyPair> all_pairs(const Scene& scene) {
    std::vector<BodyPair> pairs;
    for (std::uint32_t a = 0; a < scene.bodies.size(); ++a)
        for (std::uint32_t b = a + 1; b < scene.bodies.size(); ++b)
            if (!scene.bodies[a].fixed || !scene.bodies[b].fixed) pairs.push_back({a, b});
    return pairs;
}

/// Runs a frame among all of them, or among those that the device finds where it is to.
inline FrameResult run_among_all(Session& session, const Scene& scene, const Frame& frame) {
    if (session.settings()[parameters::broad] == Broad::device) return session.run(frame);
    return session.run(frame, all_pairs(scene));
}

inline std::string text(const SettingTexts& settings) {
    std::string result;
    for (const auto& [name, value] : settings) result += " " + name + "=" + value;
    return result;
}

} // namespace tandem::testing_support
