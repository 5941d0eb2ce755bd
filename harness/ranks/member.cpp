// SPDX-License-Identifier: MIT
// What a rank says of itself.
#include "harness/isolation/described.h"
#include "harness/ranks/machine.h"
#include "harness/ranks/roster.h"

#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sched.h>

namespace tandem {

namespace {

std::set<int> cores() {
    cpu_set_t mask;
    std::set<int> own;
    if (sched_getaffinity(0, sizeof mask, &mask) != 0) return own;
    for (int core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &mask)) own.insert(core);
    return own;
}

} // namespace

nlohmann::json member_json(std::span<const std::string> names) {
    nlohmann::json answer{{"machine", this_machine()},
                          {"cores", cores()},
                          {"backends", nlohmann::json::array()},
                          {"failure", ""}};
    try {
        answer["backends"] = describe_backends(names);
    } catch (const std::runtime_error& error) {
        answer["failure"] = fmt::format("its devices cannot be looked for: {}", error.what());
    }
    return answer;
}

Member member_of(const nlohmann::json& from) {
    return {from.at("machine").get<std::string>(), from.at("cores").get<std::set<int>>(),
            backends_of(from.at("backends")), from.at("failure").get<std::string>()};
}

} // namespace tandem
