// SPDX-License-Identifier: MIT
#pragma once

#include "harness/device_groups.h"

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

namespace tandem {

/// What a rank has, and which of it is its own: no device works for two ranks.
struct Member {
    std::string machine;                   ///< the same for ranks that share one; goes into no record
    std::set<int> cores;                   ///< of the processor, that the rank may use
    std::vector<BackendReport> backends{}; ///< described; once in a roster, its own devices only
    std::string failure{};                 ///< why nothing is known of them
};

/// A rank's answer to what devices of these names it has, and back; looks by describe_backends().
nlohmann::json member_json(std::span<const std::string> names);
Member member_of(const nlohmann::json& json);

/// Models of devices, as keys have them: what a cell asks for.
using Models = std::vector<std::string>;
Models models_of(const DeviceGroup& devices);

/// The ranks of a job with the devices of each.
class Roster {
public:
    /// GPUs of a machine that several ranks see go round these, fewest first; its processor is a rank's where
    /// no rank before it has one of its cores.
    explicit Roster(std::vector<Member> members);

    /// The devices that names ask for, each of the first rank that has such: by number among a rank's own
    /// ones, by model, one of each model of all ranks ("each", "all"), or D+E on one rank. Throws InputError
    /// that says what the ranks have.
    std::vector<DeviceGroup> choose(const std::vector<std::string>& names);
    /// The rank's own devices of these models; empty where it has not all.
    DeviceGroup devices_of(int rank, const Models& models) const;
    std::vector<int> ranks_with(const Models& models) const;

    const std::vector<Member>& members() const { return members_; }
    /// "rank 1: cuda:0 (NVIDIA H100)", a line each.
    std::string text() const;
    /// What the user had better know, a sentence each.
    const std::set<std::string>& notes() const { return notes_; }

private:
    std::vector<DeviceGroup> choose_each(const std::string& name) const;
    DeviceGroup standing_for(const DeviceGroup& group);
    DeviceGroup choose_one(const std::string& name);

    std::vector<Member> members_;
    std::set<std::string> notes_;
    std::map<Models, DeviceGroup> stand_for_; ///< the first that were asked for
};

} // namespace tandem
